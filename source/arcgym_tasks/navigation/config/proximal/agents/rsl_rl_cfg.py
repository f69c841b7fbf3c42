# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings for the colonoscope pushed from outside; each task logs to its own folder."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.agents.rsl_rl_cfg import NavigationPPORunnerCfg


@configclass
class RectumProximalPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Rectum-Proximal``."""

    experiment_name: str = "arc_rectum_proximal"


@configclass
class SigmoidProximalPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Sigmoid-Proximal``."""

    experiment_name: str = "arc_sigmoid_proximal"


@configclass
class DescendingProximalPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Descending-Proximal``."""

    experiment_name: str = "arc_descending_proximal"


@configclass
class SplenicProximalPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Splenic-Proximal``."""

    experiment_name: str = "arc_splenic_proximal"
