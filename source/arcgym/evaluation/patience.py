# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Time without progress after which an episode of a result ended as stuck: journeys have more of it than they had."""

from __future__ import annotations

import functools
from typing import Any

from arcgym.evaluation.suites import split_task

ENTRY = "stuck_after_s"
"""Entry of ``run.json``: the time by task [s], where a task ends episodes that are stuck."""

FIELD = "terminations.stuck.params.window_s"
"""Field of the environment that has it."""

UNSAID = 6.0
"""That time in runs that do not say [s]: the default of all tasks before it was written down."""

PATIENCE_MARK = "§"
"""Stands in tables behind what had another such time than the task has now."""


def patience_of(env_cfg: Any) -> float | None:
    """Return the time of an environment's configuration [s]; None where no episode ends so."""
    return getattr(env_cfg, "stuck_after_s", None)


def patience_in(run: dict[str, Any], task: str) -> float | None:
    """Return the time that a run had in a task [s]; None where the task has none, and the run says nothing else."""
    return run.get(ENTRY, {}).get(task, None if patience_registered(task) is None else UNSAID)


@functools.cache
def patience_registered(task: str) -> float | None:
    """Return the time of a task, with ``:variant`` or without, as it is registered [s]."""
    from arcgym.utils.registry import load_cfg_from_registry

    return patience_of(load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point"))


def as_text(seconds: float | None) -> str:
    """Return a time, such as ``6 s``."""
    return "none" if seconds is None else f"{seconds:g} s"
