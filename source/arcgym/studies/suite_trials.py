# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Trials of suites for the policies of a study: ``trials/<suite>/<cell>/``, all seeds of a cell in one folder.

Each is a run of ``arcgym evaluate`` with its condition file, and its folder is a result folder as of that command.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from arcgym.evaluation.result_folder import RUN_FILE, SUMMARY_FILE, TRIALS_FILE
from arcgym.evaluation.suites import read_suites, split_task
from arcgym.rl.checkpoint import file_sha256
from arcgym.studies.cell import LOG_FILE, Cell

FOLDER = "trials"
"""Folder of the result folders, in that of the study."""


@dataclass(frozen=True)
class SuiteTrials:
    """The trials of cells that differ in their seed alone."""

    suite: str
    """Name of the suite."""

    cells: tuple[Cell, ...]
    """One a seed, in the order of the seeds: trials of group g get the policy of the g-th."""

    @property
    def name(self) -> str:
        """Name of the cells, with all their seeds."""
        return self.cells[0].name_with("+".join(str(cell.seed) for cell in self.cells))

    @property
    def folder(self) -> Path:
        """Result folder."""
        return self.cells[0].study / FOLDER / self.suite / self.name

    @property
    def log(self) -> Path:
        """What the process prints, beside the result folder."""
        return self.folder.with_suffix(f".{LOG_FILE}")

    def state(self) -> str:
        """Return ``waiting`` for cells, ``pending``, ``begun``, ``finished``, or ``of other policies``.

        Results of a checkpoint are not those of a later one: a cell that was trained further needs another folder.
        """
        checkpoints = [cell.checkpoint() for cell in self.cells]
        if not all(cell.read_state()["state"] == "finished" for cell in self.cells) or None in checkpoints:
            return "waiting"
        if not (self.folder / RUN_FILE).is_file():
            return "pending"
        now = list(dict.fromkeys(file_sha256(path) for path in checkpoints if path))
        run = json.loads((self.folder / RUN_FILE).read_text())
        if list(dict.fromkeys(run["checkpoint_sha256"])) != now:
            return "of other policies"
        return "finished" if (self.folder / SUMMARY_FILE).is_file() else "begun"

    def rows(self) -> int:
        """Return how many trials have ended."""
        file = self.folder / TRIALS_FILE
        return max(file.read_bytes().count(b"\n") - 1, 0) if file.is_file() else 0

    def command(self, device: str | None) -> list[str]:
        """Return the command that runs the trials, or goes on with them."""
        words = [sys.executable, "-m", "arcgym", "evaluate", "--suite", self.suite, "--tasks", self.cells[0].task]
        words += ["--agent", ",".join(str(cell.checkpoint()) for cell in self.cells), "--out", str(self.folder)]
        return words + (["--device", device] if device else [])


def seeds_of(cells: Sequence[Cell]) -> dict[str, list[int]]:
    """Return the seeds of the cells that differ in nothing else, by their common name."""
    found: dict[str, list[int]] = {}
    for cell in cells:
        found.setdefault(cell.name_with(""), []).append(cell.seed)
    return {name: sorted(seeds) for name, seeds in found.items()}


def trials_of(cell: Cell, seeds: Sequence[int]) -> list[SuiteTrials]:
    """Return the trials that a cell takes part in, beside those with the other seeds: of its suites with its task."""
    known, robot = read_suites(), cell.task.rpartition("-")[2]
    own = tuple(replace(cell, seed=seed) for seed in seeds)
    return [
        SuiteTrials(suite, own)
        for suite in cell.suites
        if cell.task in {split_task(task)[0] for task in known[suite].tasks(robot)}
    ]


def all_trials(cells: Sequence[Cell]) -> list[SuiteTrials]:
    """Return the trials of all cells, each once."""
    seeds = seeds_of(cells)
    first = {cell.name_with(""): cell for cell in reversed(cells)}
    return [trials for name in seeds for trials in trials_of(first[name], seeds[name])]
