# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the drive of a shaft's base."""

from __future__ import annotations

from typing import Any

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.utils.configclass import configclass


@configclass
class BaseDriveCfg(ActuatorBaseCfg):
    """Pushes and rolls the shaft outside the anus, with the springs of the stage's root joint."""

    class_type: Any = "arcgym.assets.actuators.base_drive:BaseDrive"
    """Class built from this configuration."""
    force_limit: float | None = None
    """Largest push [N], over the stage's 25 N. Clinical peaks reach 43 N (Appleyard et al. 2000). Lower it for a robot
    whose drive slips."""
    torque_limit: float | None = None
    """Largest torque [N m], over the stage's 1 N m."""

    def validate_config(self) -> None:
        """Check numbers.

        Raises:
            ValueError: If a limit is not positive.
        """
        for name in ("force_limit", "torque_limit"):
            value = getattr(self, name)
            if value is not None and value <= 0.0:
                raise ValueError(f"BaseDriveCfg.{name} is {value}; expected more than 0, or None for the stage's.")
