# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runs one cell of a study in a process of its own, wherever a launcher of Hydra puts it."""

from __future__ import annotations

import fcntl
import re
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf

from arcgym.studies.cell import LOG_FILE, Cell
from arcgym.studies.grid import is_left_out, make_cell
from arcgym.studies.job_signals import JobEndedError, start_child
from arcgym.studies.stopping import was_stopped
from arcgym.studies.suite_trials import SuiteTrials, trials_of

TAIL = 15
"""Lines of the log that are kept of a cell that failed."""

POLL_S = 0.5
"""Time between two looks at a training that runs [s]."""
REPORT_S = 60.0
"""Time between two lines about it [s]."""
_WATCHED = {"iteration": r"Learning iteration (\d+)", "reward": r"Mean reward: *(\S+)"}


def run_cell(cfg: DictConfig) -> dict[str, Any]:
    """Run a cell, or go on with it, and return its name and state; what is finished is left alone.

    Args:
        cfg: Fields of :class:`arcgym.studies.study_cfg.StudyCfg` with one value for each name of the grid, and
            ``axes``, ``folder``, ``device`` and ``stop_at``.
    """
    values: Any = OmegaConf.to_container(cfg, resolve=True)
    cell = make_cell(values, Path(values["folder"]))
    if is_left_out(values):
        return {"name": cell.name, "state": "left out"}
    with _alone(cell.folder) as is_mine:
        try:
            state = _run(cell, values["device"], values["stop_at"]) if is_mine else "running"
        except Exception:  # of this process: the other cells go on
            state = "failed"
            cell.write_state(state, status="none", log=traceback.format_exc())
    if state == "finished":
        for trials in trials_of(cell, values["seeds"][cell.name_with("")]):
            _run_trials(trials, values["device"], values["stop_at"])
    return {"name": cell.name, "state": state}


def _run(cell: Cell, device: str | None, stop_at: float | None) -> str:
    """Run the cell's process unless there is nothing to do, and return the state it is left in."""
    before = cell.read_state()
    if before["state"] == "finished" and before["settings"] == cell.settings():
        return "finished"
    teacher = cell.teacher()
    if teacher is not None and teacher.read_state()["state"] != "finished":
        cell.write_state("waiting", waits_for=teacher.name)
        return "waiting"
    if _is_time(stop_at):
        return before["state"]
    seconds = before.get("seconds", 0.0)
    cell.write_state("running", seconds=seconds)
    print(f"{cell.name}: {'goes on' if cell.checkpoint() else 'starts'}", flush=True)
    start = time.monotonic()
    try:
        log_file = cell.folder / LOG_FILE
        status, stopped = _wait(cell.name, cell.command(device), log_file, stop_at, partial(describe_progress, cell))
    except JobEndedError as error:
        print(f"{cell.name}: {error}", flush=True)
        status, stopped = 0, True
    seconds += time.monotonic() - start
    state = "stopped" if stopped or status > 128 or status < 0 else "failed" if status else "finished"
    tail = {"status": status, "log": read_tail(cell)} if state == "failed" else {}
    cell.write_state(state, seconds=seconds, **tail)
    print(f"{cell.name}: {state} after {seconds:.0f} s", flush=True)
    return state


def _run_trials(trials: SuiteTrials, device: str | None, stop_at: float | None) -> None:
    """Run the trials of cells that are all finished, unless they have ended or another process runs them."""
    with _alone(trials.folder) as is_mine:
        if not is_mine or trials.state() not in ("pending", "begun") or _is_time(stop_at):
            return
        print(f"{trials.name}: trials of {trials.suite}", flush=True)
        start = time.monotonic()
        describe = partial(_count_rows, trials)
        try:
            status, _ = _wait(trials.name, trials.command(device), trials.log, stop_at, describe)
            ended = f"status {status}, see {trials.log}" if status else "done"
        except JobEndedError as error:
            ended = str(error)
        print(f"{trials.name}: {_count_rows(trials)}, {time.monotonic() - start:.0f} s: {ended}", flush=True)


def _count_rows(trials: SuiteTrials) -> str:
    return f"{trials.rows()} trials"


def _wait(
    name: str, command: list[str], log_file: Path, stop_at: float | None, describe: Callable[[], str]
) -> tuple[int, bool]:
    """Run a command and return its exit status, and whether it was asked to stop."""
    stopped, reported = False, time.monotonic()
    with log_file.open("a") as log:
        print("$", *command[1:], file=log, flush=True)
        with start_child(command, log) as process:
            while process.poll() is None:
                time.sleep(POLL_S)
                if not stopped and _is_time(stop_at):
                    stopped = True
                    process.terminate()
                if time.monotonic() - reported > REPORT_S:
                    reported = time.monotonic()
                    print(f"{name}: {describe()}", flush=True)
    return process.returncode, stopped


def _is_time(stop_at: float | None) -> bool:
    """Return whether cells are to stop."""
    return was_stopped() or (stop_at is not None and time.time() >= stop_at)


def describe_progress(cell: Cell) -> str:
    """Return where a running cell is, in words, from the end of its log."""
    text = _end_of_log(cell, 20_000)
    found = {name: re.findall(pattern, text) for name, pattern in _WATCHED.items()}
    said = [f"{name} {values[-1]}" for name, values in found.items() if values]
    return ", ".join(said) or "building"


def read_tail(cell: Cell, lines: int = TAIL) -> str:
    """Return the last lines of a cell's log."""
    return "\n".join(_end_of_log(cell, 20_000).splitlines()[-lines:])


def _end_of_log(cell: Cell, size: int) -> str:
    path = cell.folder / LOG_FILE
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - size, 0))
        return file.read().decode(errors="replace")


@contextmanager
def _alone(folder: Path) -> Iterator[bool]:
    """Yield whether no other process writes to the folder while the block does."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
            return
        yield True
