# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of an endoscope, and the three that ship with ARCGym."""

from __future__ import annotations

from typing import Any

from arcgym.assets.actuators import ActuatorBaseCfg, BaseDriveCfg, BendingDriveCfg, TipPullCfg
from arcgym.utils.configclass import MISSING, configclass
from arcgym.utils.validation import Range, require, require_non_negative, require_positive


@configclass
class IntroducerCfg:
    """Guide outside the anus, as the examiner's hand: the shaft does not buckle there. The sphincter closes around it:
    neither a loop of the shaft nor a capsule comes out."""

    stiffness_per_length: float = 4.0e4
    """Springs on the shaft outside, sideways and upwards [N/m per m of it], whatever its links. The shaft then buckles
    at 2 sqrt(EI k) = 63 N, as a beam on an elastic foundation; without, 0.5 m of it at about 1 N. Raise it for a
    stiffer guide, and with the drive's ``force_limit``."""
    damping_per_length: float = 12.0
    """Dampers beside the springs [N s/m per m of shaft]. Raise it if the shaft rattles outside."""
    height: float = 0.005
    """Height above the anal verge up to which the shaft is guided [m]."""
    slack: float = 0.01
    """How much lower than in a straight shaft, and than the anal verge, a link may be before it is lifted [m]."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_non_negative(self, "stiffness_per_length", unit="N/m^2")
        require_non_negative(self, "damping_per_length", unit="N s/m^2")
        require_non_negative(self, "height", "slack", unit="m")


@configclass
class GradingCfg:
    """Shaft that is softer towards the tip. Both lengths are measured back from the bending section, or from the front
    of a scope without one; see docs/physics.md, Scope."""

    passive_length: float = 0.0
    """Length of the passive section right behind the bending section [m]; 0 for none. 0.1 m goes with the default
    share."""
    passive_share: float = 0.4
    """Its bending rigidity over the shaft's. A choice, from 0.25 to 0.6: no scope's is published that we know of."""
    distal_length: float = 0.0
    """How far the softer distal part of the shaft reaches [m]; 0 for none. 0.3 m goes with the default share."""
    distal_share: float = 0.8
    """Its bending rigidity over the shaft's, where the passive section does not lie. A choice."""

    @property
    def active(self) -> bool:
        """Whether the shaft is graded."""
        return max(self.passive_length, self.distal_length) > 0.0

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "passive_length", Range(0.0, 3.0), unit="m")
        require(self, "distal_length", Range(0.0, 3.0), unit="m")
        require(self, "passive_share", Range(0.01, 10.0))
        require(self, "distal_share", Range(0.01, 10.0))

    def share(self, distance: float) -> float:
        """Return the rigidity at a distance [m] behind the bending section, over the shaft's."""
        if distance < self.passive_length:
            return self.passive_share
        return self.distal_share if distance < self.distal_length else 1.0


@configclass
class EndoscopeCfg:
    """An endoscope and how it is driven."""

    class_type: Any = "arcgym.assets.endoscope:Endoscope"
    """Class built from this configuration; change it to add behavior to the asset."""
    usd_path: str = MISSING
    """Stage of the scope: a path, or one relative to the assets folder (:func:`arcgym.utils.paths.assets_dir`)."""
    actuators: dict[str, ActuatorBaseCfg] = MISSING
    """Drives by name, applied in this order. Action terms find theirs by name: ``base`` and ``bending`` for
    :class:`arcgym.envs.mdp.InsertionActionCfg`, ``tip`` for :class:`arcgym.envs.mdp.TipVelocityActionCfg`."""
    expert: Any = None
    """Class of the scripted expert that drives this robot to the start states, or its name ``"module:Class"``, see
    :mod:`arcgym.experts`. None: episodes can start from rest or from states made before."""
    length: float | None = None
    """Length of a shipped scope with a shaft [m], over its 1.68 m; 2.2 m in the tasks ``ARC-Cecum``. All but 0.2 m can
    be inserted. Raise it where the cecum is farther than the scope is long, as in many patients: enteroscopes are sold
    with 2.0 m; the cost grows with the number of links."""
    shaft_rigidity: float | None = None
    """Bending rigidity EI of the hinges behind the bending section [N m^2], over the stage's."""
    tip_rigidity: float | None = None
    """Bending rigidity EI of the bending section [N m^2], over the stage's."""
    torsional_rigidity: float | None = None
    """Torsional rigidity GJ of the whole scope [N m^2/rad], over the stage's."""
    grading: GradingCfg = GradingCfg()
    """Passive section and softer distal part of the shaft; off by default."""
    introducer: IntroducerCfg = IntroducerCfg()
    """Guide outside the anus."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require(self, "length", Range(0.5, 3.0), unit="m")
        require_positive(self, "shaft_rigidity", "tip_rigidity", unit="N m^2")
        require_positive(self, "torsional_rigidity", unit="N m^2/rad")


PROXIMAL_CFG = EndoscopeCfg(
    usd_path="endoscopes/proximal.usda",
    actuators={"base": BaseDriveCfg(), "bending": BendingDriveCfg()},
    expert="arcgym.experts.push_expert:PushExpert",
)
"""Conventional colonoscope, pushed and rolled from outside, with a bending section."""

MAGNETIC_CFG = EndoscopeCfg(
    usd_path="endoscopes/magnetic.usda",
    actuators={"tip": TipPullCfg()},
    expert="arcgym.experts.pull_expert:PullExpert",
)
"""Magnetic scope: its head is pulled, its soft tether follows."""

CAPSULE_CFG = EndoscopeCfg(
    usd_path="endoscopes/capsule.usda",
    actuators={
        "tip": TipPullCfg(
            stiffness=200.0,
            damping=1.5,
            force_limit=1.0,
            angular_stiffness=0.005,
            angular_damping=1.5e-5,
            torque_limit=0.003,
        )
    },
    expert="arcgym.experts.pull_expert:PullExpert",
)
"""Free capsule, pulled with up to 1 N."""
