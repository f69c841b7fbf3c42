# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a colonoscope that is pushed and rolled from outside, with a bending section."""

from __future__ import annotations

from arcgym.assets import PROXIMAL_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import NavigationEnvCfg, NavigationSceneCfg


@configclass
class ProximalSceneCfg(NavigationSceneCfg):
    """Colon 1 with the colonoscope pushed from outside."""

    endoscope: EndoscopeCfg = PROXIMAL_CFG
    """The robot."""


@configclass
class ProximalActionsCfg:
    """Insertion and roll of the base, pitch and yaw of the bending section."""

    base: mdp.InsertionActionCfg = mdp.InsertionActionCfg()
    gas: mdp.GasFlowActionCfg | None = None
    """Off unless ``env.gas=commanded``: insufflation and suction."""
    hand: mdp.HandPressureActionCfg | None = None
    """Off unless ``env.hand_pressure=commanded``: an assistant's hand on the abdomen."""


@configclass
class ProximalEnvCfg(NavigationEnvCfg):
    """Any segment with the colonoscope pushed from outside; give it a ``segment``, or register it."""

    scene: ProximalSceneCfg = ProximalSceneCfg()
    """Colon, endoscope, camera."""

    actions: ProximalActionsCfg = ProximalActionsCfg()
    """What the policy commands."""
