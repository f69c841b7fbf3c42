# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Result folders with made-up trials."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP
from arcgym.evaluation.trials import read_conditions

TASK = "ARC-Rectum-Magnetic"
PPO = "rsl_rl_cfg_entry_point"


def write_result_folder(
    path: Path,
    successes: int,
    task: str = TASK,
    suite: str = "paper",
    every: int = 1,
    conditions_name: str | None = None,
    agents: Sequence[str] = ("/far/away/cell/run_1/model_3.pt",),
    **run: Any,
) -> Path:
    """Write a result folder whose first trials succeed, those of the suite's condition file or of an earlier one."""
    file = read_suites()[suite].conditions_path
    conditions = read_conditions(file.with_stem(conditions_name or file.stem))
    about = {
        "agent": "checkpoint",
        "checkpoint": ["/far/away/cell/run_1/model_3.pt"],
        "checkpoint_sha256": ["abcdef0123456789"],
        "training": [{"agent": PPO, "transitions": 6144}],
        "trained_on": ["colon_1/colon.usda"],
        "suite": suite,
        "conditions": conditions.name,
        "conditions_sha256": conditions.sha256,
        "overrides": [],
        "versions": {"arcgym commit": "abc1234"},
        "machine": "a machine",
        "physics_hz": {task: PHYSICS_STEP.registered(task)},
        "stuck_after_s": {} if (patience := PATIENCE.registered(task)) is None else {task: patience},
    }
    out = ResultFolder(path, about | run)
    for trial in conditions.trials[::every]:
        success = len(out.rows) < successes
        end = {"success": int(success), "end": "success" if success else "stuck", "progress": 1.0 if success else 0.5}
        figures = {"reward": 1.0 / 3.0, "seconds": 2.0, "s_c": 0.5, "centered_rate": 0.5, "tip_time_above_unsafe": 0.25}
        out.add({"task": task, "agent": agents[trial.group % len(agents)], **vars(trial), **end, **figures})
    return path
