# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a cell's process does when a cluster is about to end its job. The processes here train nothing."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time

import pytest

from arcgym.studies.cell import Cell
from arcgym.studies.job_signals import start_child
from arcgym.studies.run_cell import _run

CHILD = """
import pathlib, signal, sys, time
def leave(number, frame):
    pathlib.Path(sys.argv[1]).write_text("checkpoint")
    sys.exit(143)
signal.signal(signal.SIGTERM, leave)
print("ready", flush=True)
time.sleep(60)
"""


def wait_for(path, text):
    while text not in path.read_text():
        time.sleep(0.02)


def test_the_checkpoint_comes_before_the_queue(tmp_path):
    """Slurm sends the signal to both processes; the handler, which would end all, finds the checkpoint."""
    checkpoint, printed, found = tmp_path / "model.pt", tmp_path / "log.txt", []

    def queue_again(number, frame):
        found.append(checkpoint.is_file())
        sys.exit(-1)

    previous = signal.signal(signal.SIGUSR2, queue_again)
    try:
        with (
            pytest.raises(SystemExit),
            printed.open("w") as log,
            start_child([sys.executable, "-c", CHILD, str(checkpoint)], log) as process,
        ):
            wait_for(printed, "ready")
            process.send_signal(signal.SIGUSR2)
            threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGUSR2)).start()
            process.wait(20)
            time.sleep(1.0)
        assert found == [True]
        assert process.returncode == 143
        assert signal.getsignal(signal.SIGUSR2) is queue_again
    finally:
        signal.signal(signal.SIGUSR2, previous)


def test_without_a_handler_nothing_is_touched(tmp_path):
    with (tmp_path / "log.txt").open("w") as log, start_child([sys.executable, "-c", "pass"], log) as process:
        assert signal.getsignal(signal.SIGUSR2) is signal.SIG_DFL
        assert process.wait(20) == 0


def test_a_job_that_may_not_be_queued_again_is_no_failure(tmp_path, monkeypatch):
    """As submitit says after the last time-out: the cell goes on with the next call."""

    def refuse(number, frame):
        raise RuntimeError("timed-out too many times")

    cell = Cell(tmp_path, "ARC-Rectum-Magnetic", "ppo", 1)
    monkeypatch.setattr(Cell, "command", lambda self, device: [sys.executable, "-c", CHILD, str(tmp_path / "model.pt")])
    cell.folder.mkdir()
    log = cell.folder / "log.txt"
    log.touch()

    def signal_when_ready():
        wait_for(log, "ready\n")
        os.kill(os.getpid(), signal.SIGUSR2)

    previous = signal.signal(signal.SIGUSR2, refuse)
    try:
        threading.Thread(target=signal_when_ready, daemon=True).start()
        assert _run(cell, None, None) == "stopped"
    finally:
        signal.signal(signal.SIGUSR2, previous)
    assert cell.read_state()["state"] == "stopped"
    assert (tmp_path / "model.pt").is_file()
