# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings of a task that ``run.json`` records, so that results of an earlier default are told from those of now.

Each is a number by task: physics steps a second, length of the scope, time after which an episode counts as stuck.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from arcgym.evaluation.suites import split_task


@dataclass(frozen=True)
class TaskSetting:
    """A setting of a task: where it stands, what it was in runs that do not say, and how it is written.

    Tasks are registered names, with ``:variant`` behind them or without.
    """

    name: str
    """Name in texts, such as ``scope``."""

    entry: str
    """Entry of ``run.json`` that has the values by task; a task whose value is None is not in it."""

    field: str
    """Path of the environment's field that has it."""

    of: Callable[[Any], float | None]
    """Returns the value of an environment's configuration."""

    unsaid: float | None
    """Value in runs that do not say: the default of all tasks that have one, before it was written down."""

    text: str
    """Format of a value with its unit, such as ``{:g} m``."""

    text_of_none: str = "none"
    """Text in place of None."""

    mark: str = ""
    """Stands in tables behind what had another value than the task has now; empty where such results are not shown."""

    def registered(self, task: str) -> float | None:
        """Return the value of a task as it is registered now."""
        return _registered(self, task)

    def in_run(self, run: dict[str, Any], task: str) -> float | None:
        """Return the value that a run, as ``run.json`` holds it, had in a task.

        A run that does not say had :attr:`unsaid`, or None where the task has no value now.
        """
        unsaid = None if self.registered(task) is None else self.unsaid
        return run.get(self.entry, {}).get(task, unsaid)

    def is_present(self, run: dict[str, Any], task: str) -> bool:
        """Return whether a run had the value in a task that the task has now."""
        return self.in_run(run, task) == self.registered(task)

    def as_text(self, value: float | None) -> str:
        """Return a value with its unit, such as ``2.2 m``."""
        return self.text_of_none if value is None else self.text.format(value)


@functools.cache
def _registered(setting: TaskSetting, task: str) -> float | None:
    from arcgym.utils.registry import load_cfg_from_registry

    return setting.of(load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point"))


def _physics_steps(env_cfg: Any) -> float:
    """Return physics steps a second, such as 240."""
    return round(1.0 / env_cfg.sim.dt, 3)


def _scope_length(env_cfg: Any) -> float | None:
    """Return the length of the scope [m]; None for that of its stage, or without a scope."""
    return getattr(getattr(env_cfg.scene, "endoscope", None), "length", None)


def _stuck_after(env_cfg: Any) -> float | None:
    """Return the time without progress after which an episode ends as stuck [s]; None where none ends so."""
    return getattr(env_cfg, "stuck_after_s", None)


PHYSICS_STEP = TaskSetting(
    name="physics step",
    entry="physics_hz",
    field="sim.dt",
    of=_physics_steps,
    unsaid=480.0,
    text="1/{:g} s",
    mark="‡",
)
"""Physics steps a second, written as the length of a step."""

SCOPE_LENGTH = TaskSetting(
    name="scope",
    entry="scope_length",
    field="scene.endoscope.length",
    of=_scope_length,
    unsaid=None,
    text="{:g} m",
    text_of_none="its shipped length",
)
"""Length of the scope [m]; None is that of its stage."""

PATIENCE = TaskSetting(
    name="stuck after",
    entry="stuck_after_s",
    field="terminations.stuck.params.window_s",
    of=_stuck_after,
    unsaid=6.0,
    text="{:g} s",
    mark="§",
)
"""Time without progress after which an episode ends as stuck [s]; None where none ends so."""

SETTINGS = (PHYSICS_STEP, SCOPE_LENGTH, PATIENCE)
"""All of them."""


def marks(run: dict[str, Any], task: str) -> str:
    """Return the marks of all settings of which a run had another value in a task than the task has now."""
    return "".join(setting.mark for setting in SETTINGS if not setting.is_present(run, task))
