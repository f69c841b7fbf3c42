# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Folders of the suite ``paper`` in which every trial of the magnetic scope succeeds, and what is changed in them."""

from __future__ import annotations

from pathlib import Path

from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.task_settings import PHYSICS_STEP
from arcgym.evaluation.trials import read_conditions

CONDITIONS = read_conditions(read_suites()["paper"].conditions_path)
RUN = {
    "agent": "checkpoint",
    "checkpoint": ["a", "b", "c"],
    "checkpoint_sha256": ["abc", "def", "fed"],
    "trained_on": ["colon_1/colon.usda"],
    "suite": "paper",
    "conditions_sha256": CONDITIONS.sha256,
    "overrides": [],
}
TASKS = read_suites()["paper"].tasks("Magnetic")
RUN |= {"changes": {task: {} for task in TASKS}}
RUN |= {"inputs": {task: {"sees": ["policy"], "simulator_depth": False} for task in TASKS}}
RUN |= {"physics_hz": {task: PHYSICS_STEP.registered(task) for task in TASKS}}


def changed(task: str, **fields) -> dict:
    """A run with other settings in a task."""
    return {**RUN, "changes": RUN["changes"] | {task: {name.replace("__", "."): pair for name, pair in fields.items()}}}


def result(
    path: Path, seconds: float = 5.0, run: dict = RUN, trials: slice = slice(None), every: dict | None = None, **changes
) -> Path:
    """A folder in which every trial succeeds; ``every`` is changed in all rows, ``changes`` in the first."""
    folder = ResultFolder(path, run)
    for task in TASKS:
        for trial in CONDITIONS.trials[trials]:
            row = {
                "task": task,
                "agent": "abc"[trial.group],
                **vars(trial),
                "success": 1,
                "end": "success",
                "reward": 1.0,
            }
            row |= {"seconds": seconds + trial.trial, "progress": 1.0, "centered_rate": 1.0, "p95_tip_force": 0.0}
            row |= {"mean_tip_force": 0.0, "max_tip_force": 0.0, "peak_tip_force": 0.0}
            row |= every or {}
            folder.add(row | (changes if not folder.rows else {}))
    return path
