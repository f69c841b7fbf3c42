# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of the scene: what the policy, and the people watching it, get to see."""

import importlib
from typing import TYPE_CHECKING, Any

from arcgym.sensors.endoscope_camera_cfg import EndoscopeCameraCfg
from arcgym.sensors.lighting_cfg import ExposureCfg, LightingCfg
from arcgym.sensors.sensor_base_cfg import SensorBaseCfg

if TYPE_CHECKING:
    from arcgym.sensors.endoscope_camera import EndoscopeCamera, EndoscopeCameraData
    from arcgym.sensors.sensor_base import SensorBase
    from arcgym.sensors.skinned_surface import SkinnedSurface

_LAZY = {
    "EndoscopeCamera": "arcgym.sensors.endoscope_camera",
    "EndoscopeCameraData": "arcgym.sensors.endoscope_camera",
    "SensorBase": "arcgym.sensors.sensor_base",
    "SkinnedSurface": "arcgym.sensors.skinned_surface",
}

__all__ = [
    "EndoscopeCamera",
    "EndoscopeCameraCfg",
    "EndoscopeCameraData",
    "ExposureCfg",
    "LightingCfg",
    "SensorBase",
    "SensorBaseCfg",
    "SkinnedSurface",
]


def __getattr__(name: str) -> Any:
    """Import torch and Warp only when a runtime class is asked for."""
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
