# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Soft actor-critic whose critics give the distribution of the return."""

from __future__ import annotations

from typing import Any

import torch
from tensordict import TensorDict
from torch import nn

from arcgym.rl.algorithms.sac import SAC
from arcgym.rl.networks.q_models import with_action
from arcgym.rl.replay import ReplayBatch


def project(values: torch.Tensor, probabilities: torch.Tensor, support: torch.Tensor) -> torch.Tensor:
    """Return probabilities on ``support`` of a distribution on other values (Bellemare et al. 2017, arXiv:1707.06887).

    Each value shares its probability among the two atoms beside it, by nearness; values outside count as the ends.

    Args:
        values: Shape (B, M).
        probabilities: Of the values, shape (B, M).
        support: Evenly spaced atoms, ascending, shape (M,).
    """
    step = support[1] - support[0]
    place = ((values.clamp(support[0], support[-1]) - support[0]) / step).clamp(0, len(support) - 1)
    low = place.floor().clamp(max=len(support) - 2)
    upper_share = place - low
    result = torch.zeros_like(probabilities)
    result.scatter_add_(1, low.long(), probabilities * (1.0 - upper_share))
    result.scatter_add_(1, low.long() + 1, probabilities * upper_share)
    return result


class DistributionalSAC(SAC):
    """SAC with categorical critics (C51), as in Squint (arXiv:2602.21203).

    A critic gives probabilities of the soft return on evenly spaced atoms; its value is their mean. The target is the
    distribution of the target critic with the smaller mean, whose atoms z go to
    ``r + gamma (1 - terminated) (z - alpha log p)``, projected onto the atoms; the critics minimize the
    cross-entropy to it.
    """

    def __init__(
        self, *args: Any, num_atoms: int = 101, value_range: tuple[float, float] = (-25.0, 25.0), **kwargs: Any
    ):
        """Build SAC; other arguments as there.

        Args:
            args: Arguments of SAC.
            num_atoms: Atoms of the distribution.
            value_range: First and last atom, in units of return. Returns outside are cut off.
            kwargs: Arguments of SAC.

        Raises:
            ValueError: If the range is empty or has fewer than two atoms.
        """
        if num_atoms < 2 or not value_range[0] < value_range[1]:
            raise ValueError(
                f"num_atoms={num_atoms}, value_range={tuple(value_range)}: expected 2 atoms or more, rising."
            )
        super().__init__(*args, **kwargs)
        self.support = torch.linspace(*value_range, num_atoms, device=self.device)

    @staticmethod
    def critic_outputs(alg_cfg: dict[str, Any]) -> int:
        """Return the number of atoms."""
        return alg_cfg.get("num_atoms", 101)

    def target_distribution(self, batch: ReplayBatch) -> torch.Tensor:
        """Return the critics' target, shape (B, M)."""
        with torch.no_grad():
            actions, log_prob = self._sample(batch.next_observations)
            following = with_action(batch.next_observations, actions)
            both = self._outputs(self.targets, following).softmax(dim=-1)
            smaller = (both @ self.support).argmin(dim=0)
            chosen = both[smaller, torch.arange(len(smaller), device=both.device)]
            soft = self.support - (self.temperature * log_prob).unsqueeze(1)
            alive = (batch.discounts * (1.0 - batch.terminated)).unsqueeze(1)
            return project(batch.rewards.unsqueeze(1) + alive * soft, chosen, self.support)

    def critic_loss(self, batch: ReplayBatch) -> torch.Tensor:
        """Return the mean cross-entropy of each critic, added up."""
        target = self.target_distribution(batch)
        obs = with_action(batch.observations, batch.actions)
        logs = self._outputs(self.critics, obs).log_softmax(dim=-1)
        return -(target * logs).sum(dim=-1).mean(dim=1).sum()

    def _values(self, critics: nn.ModuleList, obs: TensorDict) -> torch.Tensor:
        return self._outputs(critics, obs).softmax(dim=-1) @ self.support
