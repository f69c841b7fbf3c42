# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the endoscope camera."""

from __future__ import annotations

import math
from typing import Any

from arcgym.sensors.lighting_cfg import ExposureCfg, LightingCfg
from arcgym.sensors.preparation_cfg import PreparationCfg
from arcgym.sensors.sensor_base_cfg import SensorBaseCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_at_least, require_positive


@configclass
class EndoscopeCameraCfg(SensorBaseCfg):
    """Color and depth from the tip of the endoscope, all worlds in one launch."""

    class_type: Any = "arcgym.sensors.endoscope_camera:EndoscopeCamera"
    """Class built from this configuration; change it to add behavior to the camera."""

    width: int = 84
    """Width of the policy's picture [px]."""

    height: int = 84
    """Height of the policy's picture [px]."""

    field_of_view: float | None = None
    """Angle from corner to corner [rad]. None takes the endoscope's own from its stage."""

    samples: int = 1
    """Rays per pixel. 4 smooths silhouettes at four times the cost; pictures of 200 px and less rarely need it."""

    data_types: tuple[str, ...] = ("rgb", "depth")
    """Outputs offered in ``data.output``: any of ``rgb`` and ``depth``. Both come from the same rays."""

    far: float = 0.6
    """Farthest distance seen [m]; depth where nothing is hit. Further than a straight stretch of colon is long."""

    lighting: LightingCfg = LightingCfg()
    """Tip lights and wet mucosa."""

    exposure: ExposureCfg = ExposureCfg()
    """Automatic exposure, shutter and response curve."""

    latency: float = 0.0
    """Age of a picture when it is seen [s], as of video processor and screen: camera and wall are drawn as they were at
    the nearest physics step. 0 draws the present; 0.08 is a colonoscope's, see ``env.clinical=[latency]``. What is
    computed from the picture and its depth, rewards and metrics of the view among them, is as late."""

    preparation: PreparationCfg = PreparationCfg()
    """Stool and fluid by how well the bowel was prepared."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require(self, "width", Range(1, 4096), unit="px")
        require(self, "height", Range(1, 4096), unit="px")
        require(self, "field_of_view", Range(0.0, 2.0 * math.pi, above=True), unit="rad")
        require_at_least(self, 1, "samples")
        require(self, "data_types", ("rgb", "depth"))
        require_positive(self, "far", unit="m")
        require(self, "latency", Range(0.0, 1.0), unit="s")
