# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What moves an endoscope: one configuration and one class for each way of driving it.

``EndoscopeCfg.actuators`` holds them by name. A robot that is driven in a new way needs a configuration whose
``class_type`` names a subclass of :class:`ActuatorBase`; both may lie in any module.
"""

from typing import TYPE_CHECKING

from arcgym.assets.actuators.actuator_base_cfg import ActuatorBaseCfg
from arcgym.assets.actuators.base_drive_cfg import BaseDriveCfg
from arcgym.assets.actuators.bending_drive_cfg import BendingDriveCfg
from arcgym.assets.actuators.tip_pull_cfg import TipPullCfg
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.assets.actuators.actuator_base import ActuatorBase
    from arcgym.assets.actuators.base_drive import BaseDrive
    from arcgym.assets.actuators.bending_drive import BendingDrive
    from arcgym.assets.actuators.tip_pull import TipPull

_LAZY = {
    "ActuatorBase": "arcgym.assets.actuators.actuator_base",
    "BaseDrive": "arcgym.assets.actuators.base_drive",
    "BendingDrive": "arcgym.assets.actuators.bending_drive",
    "TipPull": "arcgym.assets.actuators.tip_pull",
}

__all__ = [
    "ActuatorBase",
    "ActuatorBaseCfg",
    "BaseDrive",
    "BaseDriveCfg",
    "BendingDrive",
    "BendingDriveCfg",
    "TipPull",
    "TipPullCfg",
]

__getattr__ = lazy_names(__name__, _LAZY)
