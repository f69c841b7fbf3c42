# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rewards."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.managers.term_cfg import RewardTermCfg
from arcgym.managers.weighted_sum_manager import WeightedSumManager

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv


class RewardManager(WeightedSumManager):
    """Computes the reward as the weighted sum of its terms."""

    term_cfg_type = RewardTermCfg
    _env: ManagerBasedRLEnv

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Returns each term's mean episode sum over the longest episode [1/s], as Isaac Lab logs it."""
        means = super().reset(env_ids)
        return {f"Episode_Reward/{name}": mean / self._env.max_episode_length_s for name, mean in means.items()}
