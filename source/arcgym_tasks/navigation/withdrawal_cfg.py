# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What differs on the way back: the mucosa is to be seen, not only passed."""

from __future__ import annotations

from arcgym.envs import mdp
from arcgym.managers import MetricsTermCfg as MetricsTerm
from arcgym.managers import RewardTermCfg as RewTerm
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.metrics import MetricsCfg
from arcgym_tasks.navigation.navigation_env_cfg import RewardsCfg, TerminationsCfg


@configclass
class WithdrawalRewardsCfg(RewardsCfg):
    """Mucosa seen for the first time, with a little for the way back; each is multiplied by its weight and 0.1 s.

    All of the mucosa earns 50, the whole way 3, the end 5. A view along the lumen earns too little to wait for.
    """

    lumen = RewTerm(func=mdp.lumen_reward, weight=0.01)
    coverage = RewTerm(func=mdp.coverage_gain, weight=500.0)
    progress = RewTerm(func=mdp.progress, weight=-20.0)


@configclass
class WithdrawalTerminationsCfg(TerminationsCfg):
    """Standing still to look is no failure."""

    stuck = None  # type: ignore[assignment]


@configclass
class WithdrawalMetricsCfg(MetricsCfg):
    """What an inspection is judged by, with what an insertion is."""

    coverage = MetricsTerm(func=mdp.coverage, reduce="last")
    polyps_seen = MetricsTerm(func=mdp.polyps_seen, reduce="last")
    polyps = MetricsTerm(func=mdp.num_polyps, reduce="last", log=False)
    polyp_time = MetricsTerm(func=mdp.polyp_time, reduce="sum")
