# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation with a magnetic flexible endoscope, whose tip a magnet pulls on a soft tether."""

from __future__ import annotations

from arcgym.assets import MAGNETIC_CFG, EndoscopeCfg
from arcgym.envs import mdp
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.navigation_env_cfg import NavigationEnvCfg, NavigationSceneCfg


@configclass
class MagneticSceneCfg(NavigationSceneCfg):
    """Colon 1 with the magnetic flexible endoscope."""

    endoscope: EndoscopeCfg = MAGNETIC_CFG
    """The robot."""


@configclass
class MagneticActionsCfg:
    """Six velocities of the tip in its own frame."""

    tip: mdp.TipVelocityActionCfg = mdp.TipVelocityActionCfg()
    gas: mdp.GasFlowActionCfg | None = None
    """Off unless ``env.gas=commanded``: insufflation and suction."""
    hand: mdp.HandPressureActionCfg | None = None
    """Off unless ``env.hand_pressure=commanded``: an assistant's hand on the abdomen."""


@configclass
class MagneticEnvCfg(NavigationEnvCfg):
    """Any segment with the magnetic flexible endoscope; give it a ``segment``, or register it."""

    scene: MagneticSceneCfg = MagneticSceneCfg()
    """Colon, endoscope, camera."""

    actions: MagneticActionsCfg = MagneticActionsCfg()
    """What the policy commands."""
