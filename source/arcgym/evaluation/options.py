# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings of an evaluation beside tasks and trials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.evaluation.sharing import Share
from arcgym.evaluation.suites import split_task
from arcgym.rl.device import choose_device

WORLDS = {"cuda": 256, "cpu": 6}
"""Worlds at a time where no number is given, by kind of device. On a GPU a step of 256 worlds takes little longer than
one of 30. On a CPU its time grows with their number, those included for which no trial is left while the last end."""

PATIENTS = {"cuda": 256, "cpu": 64}
"""Patients at a time where no number is given, by kind of device."""

LoadCfgs = Callable[[str, Path | None], tuple[Any, Any]]
"""From task and checkpoint to the configurations of environment and agent."""


@dataclass(frozen=True)
class EvaluationOptions:
    """Settings of :func:`evaluate` beside tasks and trials."""

    agents: tuple[str, ...]
    """A name in :data:`arcgym.utils.untrained.UNTRAINED`, or checkpoints. Trials of group g get checkpoint g, or the
    only one. ``{task}`` in a path stands for the registered name of the task: each has policies of its own."""

    def agents_for(self, task: str) -> tuple[str, ...]:
        """Return the agents of a task."""
        return tuple(agent.replace("{task}", split_task(task)[0]) for agent in self.agents)

    suite: str
    """Name of the suite, for the record."""

    overrides: tuple[str, ...] = ()
    """Overrides of the configurations, for the record."""

    num_envs: int | None = None
    """Largest number of worlds at a time; None takes that of :data:`WORLDS`. Results do not depend on it."""

    num_patients: int | None = None
    """Largest number of patients in the memory of the device at a time; None takes that of :data:`PATIENTS`."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""

    share: Share = Share()
    """Trials that are run."""

    def most(self, given: int | None, usual: dict[str, int]) -> int:
        """Return a largest number of worlds or patients: the given one, or that of the kind of device."""
        return given or usual[choose_device(self.device).partition(":")[0]]
