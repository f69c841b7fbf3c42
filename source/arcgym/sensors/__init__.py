# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Sensors of the scene: what the policy and the people watching it get to see."""

from .endoscope_camera import EndoscopeCamera, EndoscopeCameraData
from .endoscope_camera_cfg import EndoscopeCameraCfg
from .lighting_cfg import ExposureCfg, LightingCfg
from .sensor_base import SensorBase, SensorBaseCfg
from .skinned_surface import SkinnedSurface

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
