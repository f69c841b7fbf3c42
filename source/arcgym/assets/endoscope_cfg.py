# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of an endoscope, and the three that ship with ARCGym."""

from __future__ import annotations

from typing import Any

from arcgym.utils.configclass import configclass


@configclass
class TipPullCfg:
    """Pull on the tip of a capsule or magnetic scope: a force-limited spring to a moving target, never a teleport."""

    stiffness: float = 400.0
    """[N/m]. The target leads the tip by at most ``force_limit / stiffness``."""
    damping: float = 4.0
    """[N s/m]."""
    force_limit: float = 4.0
    """Largest pull [N]. Magnetic colonoscopes reach 1 to 2 N in practice; 4 N passes the sigmoid with a soft tether."""
    angular_stiffness: float = 0.02
    """[N m/rad]."""
    angular_damping: float = 1.5e-4
    """[N m s/rad]."""
    torque_limit: float = 0.05
    """Largest torque [N m]."""


@configclass
class IntroducerCfg:
    """Guide outside the anus, as the examiner's hand: the shaft does not buckle there. The sphincter closes around it:
    neither a loop of the shaft nor a capsule comes out."""

    stiffness: float = 1000.0
    """Spring on every link outside [N/m], sideways and upwards. With links of 25 mm the shaft buckles at
    2 sqrt(EI k / 25 mm) = 63 N, as a beam on an elastic foundation; without, 0.5 m of it at about 1 N."""
    damping: float = 0.3
    """[N s/m]."""
    height: float = 0.005
    """Height above the anal verge up to which links are guided [m]."""
    slack: float = 0.01
    """How much lower than in a straight shaft, and than the anal verge, a link may be before it is lifted [m]."""


@configclass
class EndoscopeCfg:
    """An endoscope and how it is driven."""

    class_type: Any = "arcgym.assets.endoscope:Endoscope"
    """Class built from this configuration; change it to add behaviour to the asset."""
    usd_path: str = "endoscopes/proximal.usda"
    """Stage of the scope: a path, or one relative to the assets folder (:func:`arcgym.utils.paths.assets_dir`)."""
    shaft_rigidity: float | None = None
    """Bending rigidity EI of the hinges behind the bending section [N m^2], over the stage's."""
    tip_rigidity: float | None = None
    """Bending rigidity EI of the bending section [N m^2], over the stage's."""
    torsional_rigidity: float | None = None
    """Torsional rigidity GJ of the whole scope [N m^2/rad], over the stage's."""
    insertion_force_limit: float | None = None
    """Largest push on the base [N], over the stage's 25 N. Clinical peaks reach 43 N (Appleyard et al. 2000)."""
    roll_torque_limit: float | None = None
    """Largest torque on the base [N m], over the stage's."""
    bending_rate: float = 1.3
    """Speed of the control wheels [rad/s]."""
    tip_pull: TipPullCfg = TipPullCfg()
    """Pull on the tip, for scopes without a driven base."""
    introducer: IntroducerCfg = IntroducerCfg()
    """Guide outside the anus."""


PROXIMAL_CFG = EndoscopeCfg(usd_path="endoscopes/proximal.usda")
"""Conventional colonoscope, pushed and rolled from outside, with a bending section."""

MAGNETIC_CFG = EndoscopeCfg(usd_path="endoscopes/magnetic.usda")
"""Magnetic scope: its head is pulled, its soft tether follows."""

CAPSULE_CFG = EndoscopeCfg(
    usd_path="endoscopes/capsule.usda",
    tip_pull=TipPullCfg(
        stiffness=200.0,
        damping=1.5,
        force_limit=1.0,
        angular_stiffness=0.005,
        angular_damping=1.5e-5,
        torque_limit=0.003,
    ),
)
"""Free capsule, pulled with up to 1 N."""
