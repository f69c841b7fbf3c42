# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings for the magnetic flexible endoscope; each task logs to its own folder."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.agents.rsl_rl_cfg import NavigationPPORunnerCfg


@configclass
class RectumMagneticPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Rectum-Magnetic``."""

    experiment_name: str = "arc_rectum_magnetic"


@configclass
class SigmoidMagneticPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Sigmoid-Magnetic``."""

    experiment_name: str = "arc_sigmoid_magnetic"


@configclass
class DescendingMagneticPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Descending-Magnetic``."""

    experiment_name: str = "arc_descending_magnetic"


@configclass
class SplenicMagneticPPORunnerCfg(NavigationPPORunnerCfg):
    """``ARC-Splenic-Magnetic``."""

    experiment_name: str = "arc_splenic_magnetic"
