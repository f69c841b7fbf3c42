# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Length of the scope of a result, which tells results of a task with a shorter scope from those of the task now."""

from __future__ import annotations

import functools
from typing import Any

from arcgym.evaluation.suites import split_task

ENTRY = "scope_length"
"""Entry of ``run.json``: length of the scope by task [m], where it is not that of its stage."""

FIELD = "scene.endoscope.length"
"""Field of the environment that has it."""


def length_of(env_cfg: Any) -> float | None:
    """Return the length of the scope in an environment's configuration [m]; None for that of its stage, or no scope."""
    return getattr(getattr(env_cfg.scene, "endoscope", None), "length", None)


def length_in(run: dict[str, Any], task: str) -> float | None:
    """Return the length that a run had in a task [m]; None for that of the stage, as in all runs that do not say."""
    return run.get(ENTRY, {}).get(task)


def other_length(run: dict[str, Any], task: str) -> list[str]:
    """Return a problem if the scope of a task has another length now; none where ``changes`` of the run say so."""
    length, now = length_in(run, task), length_registered(task)
    if length == now or FIELD in run.get("changes", {}).get(task, {}):
        return []
    return [f"{task} was run with a scope of {as_text(length)}, and has a scope of {as_text(now)} now: evaluate again"]


def as_text(length: float | None) -> str:
    """Return a length in words, ``2.2 m`` or ``its shipped length``."""
    return "its shipped length" if length is None else f"{length:g} m"


@functools.cache
def length_registered(task: str) -> float | None:
    """Return the length of a task's scope as it is registered [m], or None for that of its stage."""
    from arcgym.utils.registry import load_cfg_from_registry

    return length_of(load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point"))
