# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the endoscope camera."""

from __future__ import annotations

import math
from typing import Any

from arcgym.sensors.lighting_cfg import ExposureCfg, LightingCfg
from arcgym.sensors.sensor_base_cfg import SensorBaseCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_at_least, require_positive


@configclass
class EndoscopeCameraCfg(SensorBaseCfg):
    """Colour and depth from the tip of the endoscope, all worlds in one launch."""

    class_type: Any = "arcgym.sensors.endoscope_camera:EndoscopeCamera"
    """Class built from this configuration; change it to add behaviour to the camera."""

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
    """Automatic exposure and response curve."""

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
