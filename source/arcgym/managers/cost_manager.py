# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Costs, for algorithms that bound them."""

from __future__ import annotations

import torch

from arcgym.managers.term_cfg import CostTermCfg
from arcgym.managers.weighted_sum_manager import WeightedSumManager


class CostManager(WeightedSumManager):
    """Computes the cost as the weighted sum of its terms, apart from the reward."""

    term_cfg_type = CostTermCfg

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Returns each term's mean episode sum: what a limit on the cost of an episode bounds."""
        return {f"Episode_Cost/{name}": mean for name, mean in super().reset(env_ids).items()}
