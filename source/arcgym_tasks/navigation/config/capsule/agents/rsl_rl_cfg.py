# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings for the capsule; each task logs to its own folder."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.agents.rsl_rl_cfg import NavigationPPORunnerCfg


@configclass
class RectumCapsulePPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Rectum-Capsule``."""

    experiment_name: str = "arc_rectum_capsule"


@configclass
class SigmoidCapsulePPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Sigmoid-Capsule``."""

    experiment_name: str = "arc_sigmoid_capsule"


@configclass
class DescendingCapsulePPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Descending-Capsule``."""

    experiment_name: str = "arc_descending_capsule"


@configclass
class SplenicCapsulePPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Splenic-Capsule``."""

    experiment_name: str = "arc_splenic_capsule"
