# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Results of a task whose scope had another length."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from result_folders import write_result_folder

from arcgym.evaluation.check import problems
from arcgym.evaluation.compare import notes
from arcgym.evaluation.result_folder import ResultFolder, read_run
from arcgym.evaluation.results import find_results
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.task_settings import PHYSICS_STEP
from arcgym.evaluation.trials import read_conditions


def test_results_of_a_shorter_scope_are_no_results_of_the_task(tmp_path: Path) -> None:
    """Of the two tasks of a folder, the one that has the shipped length is shown all the same."""
    of: dict[str, Any] = {"suite": "ct", "agent": "expert", "checkpoint": [], "checkpoint_sha256": [], "training": []}
    task, other = "ARC-Cecum-Magnetic", "ARC-LeftColon-Magnetic"
    of |= {
        "changes": {task: {}, other: {}},
        "physics_hz": {task: PHYSICS_STEP.registered(task), other: PHYSICS_STEP.registered(other)},
    }
    conditions = read_conditions(read_suites()["ct"].conditions_path)
    for name, lengths in (("old", {}), ("new", {"scope_length": {task: 2.2}})):
        folder = write_result_folder(tmp_path / name, 0, task, **of | lengths)
        for trial in conditions.trials:
            row = {"task": other, "agent": "expert", **vars(trial), "success": 0, "end": "stuck", "progress": 0.5}
            more = {"reward": 1.0, "seconds": 2.0, "s_c": 0.5, "centered_rate": 0.5, "tip_time_above_unsafe": 0.25}
            ResultFolder(folder, read_run(folder)).add(row | more)
    message = f"{task} was run with a scope of its shipped length, and has a scope of 2.2 m now: evaluate again"
    assert problems(tmp_path / "old") == [message] and problems(tmp_path / "new") == []
    found, left_out = find_results([tmp_path])
    assert [(one.folder.name, one.task) for one in found] == [("new", task), ("new", other), ("old", other)]
    assert left_out == {tmp_path / "old": [message]}
    assert f"note: {task} scope is its shipped length in {tmp_path / 'old'} and 2.2 m in {tmp_path / 'new'}" in notes(
        tmp_path / "old", tmp_path / "new"
    )
