# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the bending section's drive."""

from __future__ import annotations

from typing import Any

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_positive


@configclass
class BendingDriveCfg(ActuatorBaseCfg):
    """Bends the distal section, as the control wheels of a colonoscope do."""

    class_type: Any = "arcgym.assets.actuators.bending_drive:BendingDrive"
    """Class built from this configuration."""
    rate: float = 1.3
    """Speed of the control wheels [rad/s]. Raise it if actions command faster bending than 0.13 rad a step of 0.1 s."""
    play: float = 0.0
    """Play of the cables [rad]: how far the wheel turns from where it stands in the middle before the section follows,
    to either side. 0 for none; 0.26 rad, 15 degrees, is a choice for a used colonoscope, new ones have less. The
    section then bends by so much less than the wheel turns."""
    lag: float = 0.0
    """Time constant with which the section follows its cables [s]. 0 for none; 0.05 s is a choice."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_positive(self, "rate", unit="rad/s")
        require(self, "play", Range(0.0, 1.5), unit="rad")
        require(self, "lag", Range(0.0, 2.0), unit="s")
