# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO whose policy is also told what to do where it is lost."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from rsl_rl.utils import unpad_trajectories

from arcgym.rl.algorithms.further_loss import FurtherLoss
from arcgym.rl.algorithms.ppo_bounded import PPOBounded, bounds_loss
from arcgym.utils.errors import UsageError

LESSON = "lesson"
"""Observation group that no network reads: actions, then the weight of each."""


class PPOTaught(PPOBounded):
    """PPO with means within bounds and one more loss, which draws them to the actions of a lesson.

    The policy drives, and a steering that sees what no image shows says what it should have done (DAgger, Ross et al.
    2011, arXiv:1011.0686), beside what reward teaches: an imitation loss added to a policy gradient (DAPG, Rajeswaran
    et al. 2018, arXiv:1709.10087). The lesson is an observation group, so that a task decides where there is one.
    """

    def __init__(
        self,
        actor: MLPModel,
        critic: MLPModel,
        storage: RolloutStorage,
        bounds_loss_coef: float = 1.0,
        lesson_coef: float = 1.0,
        **kwargs: Any,
    ):
        """Build PPO.

        Args:
            actor: Policy with a normal distribution of A actions, with or without memory.
            critic: Value function.
            storage: Rollout storage, whose observations have a group ``lesson`` of shape (N, 2 A).
            bounds_loss_coef: Weight of the squared difference to the means that acted, within bounds.
            lesson_coef: Weight of the squared difference to the lesson.
            kwargs: Further arguments of PPO.

        Raises:
            UsageError: The observations have no lesson, or it is of another size.
        """
        super().__init__(actor, critic, storage, bounds_loss_coef, **kwargs)
        _check_lesson(storage)
        self.symmetry = self._taught = _TaughtLoss(bounds_loss_coef, lesson_coef)  # type: ignore[assignment]

    def update(self) -> dict[str, float]:
        """Make the gradient steps of an iteration and return the mean losses.

        ``bounds`` and ``lesson`` are without their coefficients; ``lesson_error`` is the mean squared difference of an
        action where there is a lesson, whatever the share of such steps.
        """
        self._taught.parts.clear()
        losses = super().update()
        bounds, lesson, weight = torch.stack(self._taught.parts).mean(dim=0).tolist()
        return {**losses, "bounds": bounds, "lesson": lesson, "lesson_error": lesson / max(weight, 1e-6)}


def lesson_loss(mean: torch.Tensor, lesson: torch.Tensor) -> torch.Tensor:
    """Return the weighted squared difference to a lesson, summed over the actions; mean over the rest.

    Args:
        mean: Mean actions, shape (..., A).
        lesson: Actions, then their weights, shape (..., 2 A).
    """
    actions, weights = lesson.chunk(2, dim=-1)
    return (weights * (mean - actions).square()).sum(dim=-1).mean()


class _TaughtLoss(FurtherLoss):
    """Draws the means of a mini-batch back within bounds, and to the lesson."""

    def __init__(self, bounds_coef: float, lesson_coef: float):
        super().__init__(1.0)
        self._coefs = bounds_coef, lesson_coef
        self.parts: list[torch.Tensor] = []
        """Both losses of each mini-batch and the mean sum of the lesson's weights, shape (3,)."""

    def compute_loss(self, actor: MLPModel, batch: Any, size: int) -> torch.Tensor:
        """Return the weighted sum of both; the policy has just seen this mini-batch."""
        mean, lesson = actor.output_distribution_params[0], batch.observations[LESSON]
        if batch.masks is not None:  # of a policy with memory, which learns on padded pieces of episodes
            lesson = unpad_trajectories(lesson, batch.masks)
        bounds, taught = bounds_loss(mean, batch.old_distribution_params[0]), lesson_loss(mean, lesson)
        weight = lesson[..., mean.shape[-1] :].sum(dim=-1).mean()
        self.parts.append(torch.stack((bounds, taught, weight)).detach())
        return self._coefs[0] * bounds + self._coefs[1] * taught


def _check_lesson(storage: RolloutStorage) -> None:
    """Raise :class:`UsageError` if the observations have no lesson, or it does not fit the actions."""
    groups = storage.observations
    if LESSON not in groups.keys():
        raise UsageError(
            f"ppo_taught needs an observation group '{LESSON}'; this task has {', '.join(map(str, groups.keys()))}. "
            f"Set env.extra_observations=[{LESSON}]."
        )
    width, expected = groups[LESSON].shape[-1], 2 * storage.actions.shape[-1]
    if width != expected:
        raise UsageError(
            f"Observation group '{LESSON}' has {width} numbers, expected {expected}: actions, then their weights."
        )
