# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Costs, for algorithms that bound them."""

from __future__ import annotations

from arcgym.managers.term_cfg import CostTermCfg
from arcgym.managers.weighted_sum_manager import WeightedSumManager


class CostManager(WeightedSumManager):
    """Computes the cost as the weighted sum of its terms, apart from the reward.

    It logs mean episode sums: what a limit on the cost of an episode bounds.
    """

    term_cfg_type = CostTermCfg
    log_name = "Episode_Cost"
