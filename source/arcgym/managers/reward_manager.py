# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rewards."""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.managers.term_cfg import RewardTermCfg
from arcgym.managers.weighted_sum_manager import WeightedSumManager

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv


class RewardManager(WeightedSumManager):
    """Computes the reward as the weighted sum of its terms; logs mean episode sums over the longest episode [1/s]."""

    term_cfg_type = RewardTermCfg
    log_name = "Episode_Reward"
    _env: ManagerBasedRLEnv

    def _log_divisor(self) -> float:
        """Longest episode [s]: Isaac Lab logs sums over it."""
        return self._env.max_episode_length_s
