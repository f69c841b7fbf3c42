# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Physics steps a second of a result, which tell results of an earlier physics from those of the task as it is now."""

from __future__ import annotations

import functools
from typing import Any

from arcgym.evaluation.suites import split_task

ENTRY = "physics_hz"
"""Entry of ``run.json``: physics steps a second by task."""

UNSAID = 480.0
"""Physics steps a second of runs that do not say: the default of all tasks before it was written down."""

STEP_MARK = "‡"
"""Stands in tables behind what had another physics step than the task has now."""


def steps_of(env_cfg: Any) -> float:
    """Return the physics steps a second of an environment's configuration, such as 240."""
    return round(1.0 / env_cfg.sim.dt, 3)


def steps_in(run: dict[str, Any], task: str) -> float:
    """Return the physics steps a second that a run made of a task."""
    return float(run.get(ENTRY, {}).get(task, UNSAID))


@functools.cache
def steps_registered(task: str) -> float:
    """Return the physics steps a second of a task, with ``:variant`` or without, as it is registered."""
    from arcgym.utils.registry import load_cfg_from_registry

    return steps_of(load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point"))


def as_text(steps: float) -> str:
    """Return the length of a step, such as ``1/240 s``."""
    return f"1/{steps:g} s"
