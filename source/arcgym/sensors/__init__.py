# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of the scene: what the policy, and the people watching it, get to see."""

from typing import TYPE_CHECKING

from arcgym.sensors.endoscope_camera_cfg import EndoscopeCameraCfg
from arcgym.sensors.lighting_cfg import ExposureCfg, LightingCfg
from arcgym.sensors.preparation_cfg import PreparationCfg
from arcgym.sensors.sensor_base_cfg import SensorBaseCfg
from arcgym.utils.lazy import lazy_names

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
    "PreparationCfg",
    "SensorBase",
    "SensorBaseCfg",
    "SkinnedSurface",
]

__getattr__ = lazy_names(__name__, _LAZY)
