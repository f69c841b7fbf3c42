# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shares of an evaluation's trials, for several processes or machines. Loads neither torch nor Warp."""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from arcgym.evaluation.merge import merge
from arcgym.evaluation.result_folder import (
    DROPPED,
    PARTS,
    RUN_FILE,
    TRIALS_FILE,
    ResultFolder,
    alone_in,
    read_run,
    read_trial_rows,
)
from arcgym.evaluation.trials import Trial
from arcgym.utils.errors import UsageError
from arcgym.utils.progress import counted

LOOK_EVERY = 0.5
"""Time between two looks at how many trials have ended [s]."""


@dataclass(frozen=True)
class Share:
    """Which trials are run: each ``of``-th one of the condition file, from the ``number``-th on."""

    number: int = 1
    """1 to ``of``."""

    of: int = 1
    """Number of shares; 1 is all trials."""

    def __str__(self) -> str:
        """Return the share as the command line takes it, ``2/4``."""
        return f"{self.number}/{self.of}"

    def trials(self, trials: Sequence[Trial]) -> list[Trial]:
        """Return this share of trials."""
        return list(trials[self.number - 1 :: self.of])


def share(text: str) -> Share:
    """Read a share from the command line, such as ``2/4``."""
    match = re.fullmatch(r"(\d+)/(\d+)", text)
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise argparse.ArgumentTypeError(f"'{text}' is no share, expected k/n with k from 1 to n, such as 2/4")
    return Share(int(match[1]), int(match[2]))


def gather(out: Path) -> None:
    """Put the rows of shares that were cut off, if there are any, into the folder of all rows.

    Raises:
        UsageError: They are of another evaluation.
    """
    parts = sorted(file.parent for file in out.glob(f"{PARTS}/*/{RUN_FILE}"))
    if parts:
        merge(parts, out)


def run_shares(
    words: Sequence[str], processes: int, trials: Sequence[Trial], num_tasks: int, out: Path
) -> ResultFolder:
    """Run an evaluation in several processes, each with its share of the trials, and return the folder of all rows.

    Each share has a folder and a log below :data:`PARTS`. The same call goes on where one was cut off, also with
    another number of processes.

    Args:
        words: Arguments of ``arcgym evaluate`` but ``--out`` and ``--share``.
        processes: Number of processes.
        trials: Trials of each task.
        num_tasks: Number of tasks.
        out: Folder of the results.

    Raises:
        UsageError: A process failed, with the last line of its log, or the folder is written to by another call.
    """
    with alone_in(out):
        gather(out)
        return _run_shares(
            words, [Share(number, processes) for number in range(1, processes + 1)], trials, num_tasks, out
        )


def _run_shares(
    words: Sequence[str], shares: Sequence[Share], trials: Sequence[Trial], num_tasks: int, out: Path
) -> ResultFolder:
    folders = [out / PARTS / f"{part.number}_of_{part.of}" for part in shares]
    (out / PARTS).mkdir(parents=True, exist_ok=True)
    for part, folder in zip(shares, folders, strict=True):
        _hand_down(out, folder, {trial.trial for trial in part.trials(trials)})
    running = [_start([*words, "--share", str(part)], folder) for part, folder in zip(shares, folders, strict=True)]
    try:
        failed = _wait(running, folders, len(trials) * num_tasks)
    finally:
        for process in running:
            process.kill()
            process.wait()
    if failed is not None:
        log = folders[failed].with_suffix(".log")
        lines = log.read_text().strip().splitlines() or ["no message"]
        raise UsageError(f"Share {shares[failed]} failed, see {log}: {lines[-1]}")
    return merge(folders, out)


def _hand_down(out: Path, folder: Path, numbers: set[int]) -> None:
    """Give a share the rows of its trials that the whole has already."""
    if not (out / RUN_FILE).is_file():
        return
    run = read_run(out)
    run.pop(DROPPED, None)  # the whole has them already
    part = ResultFolder(folder, run)
    known = {(row["task"], row["trial"]) for row in part.rows}
    for row in read_trial_rows(out):
        if row["trial"] in numbers and (row["task"], row["trial"]) not in known:
            part.add(row)


def _start(words: Sequence[str], folder: Path) -> subprocess.Popen:
    command = [sys.executable, "-m", "arcgym", "evaluate", *words, "--out", str(folder)]
    with folder.with_suffix(".log").open("w") as log:
        return subprocess.Popen(
            command, stdout=log, stderr=subprocess.STDOUT, env={**os.environ, "OMP_NUM_THREADS": "1"}
        )


def _wait(running: Sequence[subprocess.Popen], folders: Sequence[Path], num_trials: int) -> int | None:
    """Show how many trials have ended until all processes have, or one has failed, whose number is returned."""
    with counted(f"trials in {len(running)} processes", num_trials) as show:
        while True:
            codes = [process.poll() for process in running]
            show(sum(_num_rows(folder / TRIALS_FILE) for folder in folders))
            failed = next((number for number, code in enumerate(codes) if code), None)
            if failed is not None or None not in codes:
                return failed
            time.sleep(LOOK_EVERY)


def _num_rows(file: Path) -> int:
    return max(file.read_bytes().count(b"\n") - 1, 0) if file.is_file() else 0
