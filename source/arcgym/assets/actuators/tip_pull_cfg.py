# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the pull on a tip."""

from __future__ import annotations

from typing import Any

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_non_negative, require_positive


@configclass
class TipPullCfg(ActuatorBaseCfg):
    """Pulls the tip of a capsule or magnetic scope: a force-limited spring to a moving target, never a teleport."""

    class_type: Any = "arcgym.assets.actuators.tip_pull:TipPull"
    """Class built from this configuration."""
    stiffness: float = 400.0
    """Spring from the tip to its target [N/m]. The target leads the tip by at most ``force_limit / stiffness``:
    lower it for a softer pull, raise it for one that follows commands at once."""
    damping: float = 4.0
    """Damper beside that spring [N s/m]. Raise it if the tip overshoots its target."""
    force_limit: float = 4.0
    """Largest pull [N]. Magnetic colonoscopes reach 1 to 2 N in practice; 4 N passes the sigmoid with a soft tether."""
    angular_stiffness: float = 0.02
    """Spring that turns the tip to its target [N m/rad], which leads by at most ``torque_limit / angular_stiffness``:
    raise it for turns that follow commands sooner, and are undone sooner."""
    angular_damping: float = 1.5e-4
    """Damper beside that spring [N m s/rad]. Raise it if the tip swings."""
    torque_limit: float = 0.05
    """Largest torque on the tip [N m]. Raise it for a magnet that turns the tip against a wall."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_positive(self, "stiffness", unit="N/m")
        require_positive(self, "force_limit", unit="N")
        require_positive(self, "angular_stiffness", unit="N m/rad")
        require_positive(self, "torque_limit", unit="N m")
        require_non_negative(self, "damping", unit="N s/m")
        require_non_negative(self, "angular_damping", unit="N m s/rad")
