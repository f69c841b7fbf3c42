# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a capsule of 10 x 20 mm that a magnet moves."""

from __future__ import annotations

from arcgym.assets import CAPSULE_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import NavigationEnvCfg, NavigationSceneCfg


@configclass
class CapsuleSceneCfg(NavigationSceneCfg):
    """Colon 1 with the magnetically moved capsule."""

    endoscope: EndoscopeCfg = CAPSULE_CFG
    """The robot."""


@configclass
class CapsuleActionsCfg:
    """Six velocities of the capsule in its own frame."""

    capsule: mdp.TipVelocityActionCfg = mdp.TipVelocityActionCfg(linear_scale=0.05)
    gas: mdp.GasFlowActionCfg | None = None
    """Off unless ``env.gas=commanded``: insufflation and suction."""
    hand: mdp.HandPressureActionCfg | None = None
    """Off unless ``env.hand_pressure=commanded``: an assistant's hand on the abdomen."""


@configclass
class CapsuleEnvCfg(NavigationEnvCfg):
    """Any segment with the magnetically moved capsule; give it a ``segment``, or register it."""

    scene: CapsuleSceneCfg = CapsuleSceneCfg()
    """Colon, endoscope, camera."""

    actions: CapsuleActionsCfg = CapsuleActionsCfg()
    """What the policy commands."""
