# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the drive of a shaft's base."""

from __future__ import annotations

from typing import Any

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_positive


@configclass
class BaseDriveCfg(ActuatorBaseCfg):
    """Pushes and rolls the shaft outside the anus, with the springs of the stage's root joint."""

    class_type: Any = "arcgym.assets.actuators.base_drive:BaseDrive"
    """Class built from this configuration."""
    force_limit: float | None = None
    """Largest push [N], over the stage's 43 N, the clinical peak (Appleyard et al. 2000). Lower it for a robot whose
    drive slips."""
    torque_limit: float | None = None
    """Largest torque [N m], over the stage's 1 N m."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_positive(self, "force_limit", unit="N")
        require_positive(self, "torque_limit", unit="N m")
