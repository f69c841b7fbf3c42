# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Hands out trials to worlds as they become free."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from arcgym.evaluation.trials import Trial


class TrialQueue:
    """Seeds of episodes by trial: a world that begins an episode takes the next trial.

    It is a :data:`arcgym.utils.world_random.SeedSource`. A world for which no trial is left makes an episode that does
    not count.
    """

    def __init__(self, trials: Sequence[Trial], num_envs: int, patients: Sequence[str] = ()) -> None:
        """Hold the trials.

        Args:
            trials: Trials in the order in which they are handed out.
            num_envs: Number of worlds N.
            patients: Patients of the environment, in the order of ``colon.patients``.
        """
        self._places = {patient: place for place, patient in enumerate(patients)}
        self._waiting = list(reversed(trials))
        self._running: list[Trial | None] = [None] * num_envs

    def __call__(self, env_ids: torch.Tensor) -> torch.Tensor:
        """Give the worlds that begin an episode their trials, and return the trials' seeds, shape (n,)."""
        return torch.tensor([self._next(world) for world in env_ids.tolist()], dtype=torch.long)

    def patients(self, env_ids: torch.Tensor) -> torch.Tensor:
        """Return the patients of the trials that run in some worlds, index into ``colon.patients``, shape (n,)."""
        trials = [self._running[world] for world in env_ids.tolist()]
        return torch.tensor([0 if trial is None else self._places[trial.patient] for trial in trials])

    @property
    def running(self) -> list[Trial | None]:
        """Trial of every world, None for one that makes an episode that does not count."""
        return list(self._running)

    @property
    def left(self) -> int:
        """Trials that have not ended."""
        return len(self._waiting) + sum(trial is not None for trial in self._running)

    def _next(self, world: int) -> int:
        self._running[world] = self._waiting.pop() if self._waiting else None
        trial = self._running[world]
        return trial.seed if trial else 0


def give_patient_of_trial(env: Any, env_ids: torch.Tensor) -> None:
    """Event that puts the patients of their trials into worlds that begin one; it comes before the reset."""
    queue = env.random.seed_source
    if isinstance(queue, TrialQueue):
        env.scene["colon"].write_patient_to_sim(queue.patients(env_ids), env_ids)
