# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The throughput benchmark: command line, rows, stages."""

from __future__ import annotations

import json
import subprocess
import sys
from argparse import ArgumentTypeError, Namespace
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "scripts" / "benchmarks"
ROW = {
    "num_envs": 4,
    "env_steps_per_s": 8.0,
    "sim_s_per_wall_s": 0.8,
    "ms": {"total": 500.0},
    "device_mib": None,
    "host_mib": 900.0,
    "build_s": 10.0,
    "compile_s": 0.5,
}


def run(*arguments: str, flags: tuple[str, ...] = (), timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *flags, str(FOLDER / "throughput.py"), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=timeout)


@pytest.fixture
def throughput(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import throughput

    return throughput


def test_help_needs_no_heavy_imports():
    result = run("--help", flags=("-X", "importtime"))
    assert result.returncode == 0, result.stderr
    imported = {line.split("|")[-1].strip() for line in result.stderr.splitlines()}
    assert not {"torch", "warp", "newton", "mujoco"} & imported


def test_unknown_task_ends_before_anything_is_built():
    result = run("--task", "ARC-Splenic-Proxmal", "--device", "cpu")
    assert result.returncode == 2
    assert "ARC-Splenic-Proximal" in result.stderr


def test_counts_are_separated_by_commas(throughput):
    assert throughput.counts("1,16,64") == [1, 16, 64]
    with pytest.raises(ArgumentTypeError, match="at least 1"):
        throughput.counts("4,0")


def worker_args() -> Namespace:
    return Namespace(task="T", device="cpu", steps=1, repeats=1, seed=0, stages=False, timeout=60.0)


@pytest.mark.parametrize(
    ("code", "error"),
    [
        ("raise SystemExit('out of memory')", "out of memory"),
        ("import os; os.kill(os.getpid(), 9)", "ended by signal 9, perhaps for lack of memory: no message"),
    ],
)
def test_failed_worker_gives_a_row_with_its_last_words(throughput, monkeypatch, tmp_path, code, error):
    script = tmp_path / "worker.py"
    script.write_text(code)
    monkeypatch.setattr(throughput, "__file__", str(script))
    assert throughput.run_worker(worker_args(), 4096, []) == {"num_envs": 4096, "error": error}


def test_row_is_the_last_line_of_the_worker(throughput, monkeypatch, tmp_path):
    script = tmp_path / "worker.py"
    script.write_text(f"print('Module loaded'); print({json.dumps(ROW)!r})")
    monkeypatch.setattr(throughput, "__file__", str(script))
    assert throughput.run_worker(worker_args(), 4, []) == ROW


def test_line_has_a_dash_for_the_memory_of_no_device(throughput):
    assert throughput.describe(ROW).split() == ["4", "8.0", "0.80", "500.00", "-", "900", "10.0", "0.5"]


def test_median_leaves_the_first_call_out(throughput):
    import time

    import warp as wp
    from _common import median_ms

    wp.init()
    waits = iter([0.2, 0.01, 0.01, 0.01])
    assert 10.0 <= median_ms(lambda: time.sleep(next(waits)), "cpu", repeats=3) < 100.0


def test_silenced_method_comes_back(throughput):
    from _stages import silenced

    found: list[int] = []
    with silenced((throughput, "counts")):
        assert throughput.counts("0") is None
    found += throughput.counts("2")
    assert found == [2]


@pytest.mark.slow
def test_measures_every_stage_on_the_cpu():
    arguments = ["--task=ARC-Rectum-Capsule", "--num_envs=1", "--steps=2", "--repeats=1", "--device=cpu", "--stages"]
    result = run(*arguments, "--json")
    assert result.returncode == 0, result.stderr
    report = json.loads(result.stdout.splitlines()[-1])
    (row,) = report["rows"]
    assert row["num_envs"] == 1 and row["device_mib"] is None
    assert row["sim_s_per_wall_s"] == pytest.approx(0.1 * row["env_steps_per_s"])
    parts = {"total", "physics", "contact", "scope", "wall", "camera", "managers", "observation", "reset"}
    assert parts <= row["ms"].keys()
    assert min(row["ms"].values()) > 0.0
