# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO whose mean actions stay within what is carried out."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage

from arcgym.rl.algorithms.further_loss import FurtherLoss

BOUND = 1.0
"""Largest raw action that an action term carries out."""


class PPOBounded(PPO):
    """PPO with one more loss, which brings mean actions back into [-1, 1] and hardly changes what is carried out.

    Action terms cut raw actions at -1 and 1. Beyond a bound all samples are cut to the same action: nothing else is
    tried, no advantage says so, and the mean drifts on. A policy that is stuck then stays so, however long it learns.
    So each mean is drawn to what was carried out in the rollout, its former value cut at the bounds. Within the bounds
    this holds a policy near the last one, as a penalty on their divergence does (Schulman et al. 2017, section 4).
    """

    def __init__(
        self, actor: MLPModel, critic: MLPModel, storage: RolloutStorage, bounds_loss_coef: float = 1.0, **kwargs: Any
    ):
        """Build PPO.

        Args:
            actor: Policy with a normal distribution.
            critic: Value function.
            storage: Rollout storage.
            bounds_loss_coef: Weight of the squared difference, summed over the actions.
            kwargs: Further arguments of PPO.
        """
        super().__init__(actor, critic, storage, **kwargs)
        self.symmetry = _BoundsLoss(bounds_loss_coef)  # type: ignore[assignment]

    def update(self) -> dict[str, float]:
        """Make the gradient steps of an iteration and return the mean losses."""
        losses = super().update()
        losses["bounds"] = losses.pop("symmetry")
        return losses


class _BoundsLoss(FurtherLoss):
    """Draws the means of a mini-batch back."""

    def compute_loss(self, actor: MLPModel, batch: Any, size: int) -> torch.Tensor:
        """Return the mean loss of the mini-batch that the policy has just seen."""
        return bounds_loss(actor.output_distribution_params[0], batch.old_distribution_params[0])


def bounds_loss(mean: torch.Tensor, former: torch.Tensor) -> torch.Tensor:
    """Return the squared difference to the former means, cut at -1 and 1, summed over the actions; mean over the rest.

    Args:
        mean: Mean actions, shape (N, A).
        former: Mean actions of the policy that acted, same shape.
    """
    return (mean - former.clamp(-BOUND, BOUND)).square().sum(dim=-1).mean()
