# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the pictures of ``env.render()`` and of videos."""

from __future__ import annotations

import math
from typing import Any, Literal

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import (
    FINITE,
    Range,
    require,
    require_at_least,
    require_fraction,
    require_non_negative,
    require_positive,
)


@configclass
class OutsideViewCfg:
    """Camera and look of the outside view."""

    width: int = 560
    """Width of the picture [px]."""
    height: int = 512
    """Height of the picture [px]."""
    azimuth: float = 0.0
    """Turn of the camera around the body axis [rad]: 0 looks from anterior, +pi/2 from the patient's left. Change it
    to see the sigmoid loop, which rises towards the front, from the side."""
    elevation: float = math.radians(8.0)
    """Height of the camera above the transverse plane [rad], within ±85°."""
    distance: float = 1.6
    """From the camera to the middle of the colon [m]. Smaller values exaggerate the perspective."""
    outside_length: float = 0.07
    """Part of the scope below the anus that is kept in the picture [m]."""
    wall_color: Literal["displacement", "strain", "tension", "force"] = "displacement"
    """Quantity that the wall's color shows: how far it moved, its strain, the pull of its anchors, or the force of the
    scope beside it."""
    scope_color: Literal["force", "plain"] = "force"
    """Whether the scope is colored by the force of the wall on each window of 50 mm."""
    wall_full_scale: float | None = None
    """Value of the wall that gets the last color; None for 50 mm, a strain of 10 %, a pull of 1 N, or a force just
    above the perforation tier. Lower it for gentle robots."""
    near_alpha: float = 0.16
    """Opacity of the wall that faces the camera, 0..1. Higher values hide the scope."""
    rim_alpha: float = 0.70
    """Opacity added towards silhouettes, 0..1."""
    far_alpha: float = 0.97
    """Opacity of the wall that is seen through the lumen, 0..1."""
    ghost_alpha: float = 0.42
    """Opacity of the far wall where the scope lies behind it, 0..1."""
    scope_share: float = 0.4
    """Smallest share of the scope in the picture, 0..1, however many loops of the colon lie before it."""
    edge_threshold: float = 0.06
    """Difference of neighboring pixels (0..1) from which a pixel is traced four times. 2 switches anti-aliasing off.
    """
    depth_contrast: float = 0.7
    """Strength of the shade behind loops that lie in front of others, 0..1."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "width", Range(64, 4096), unit="px")
        require(self, "height", Range(64, 4096), unit="px")
        require(self, "azimuth", FINITE, unit="rad")
        require(self, "elevation", Range(-math.radians(85.0), math.radians(85.0)), unit="rad")
        require_positive(self, "distance", unit="m")
        require_non_negative(self, "outside_length", unit="m")
        require_positive(self, "wall_full_scale")
        require_fraction(self, "near_alpha", "rim_alpha", "far_alpha", "ghost_alpha", "scope_share", "depth_contrast")
        require_non_negative(self, "edge_threshold")


@configclass
class ViewerCfg:
    """Picture of one world: the endoscope's view beside the outside view, with numbers below."""

    class_type: Any = "arcgym.viewers.two_pane:TwoPaneView"
    """Class, or its text ``"module:Class"``, that is built as ``class_type(env, cfg)`` and draws ``frame(env_id)``.
    Change it, and subclass this configuration for its settings, to draw another picture."""

    env_id: int = 0
    """World that ``env.render()`` draws."""

    outside: OutsideViewCfg = OutsideViewCfg()
    """Camera, colors and look of the outside view; its height is the endoscope view's size too."""

    samples: int = 2
    """Rays a pixel of the endoscope's view. 1 is twice as fast, 4 gives the smoothest edges."""

    metrics: tuple[str, ...] = ("s_c", "s_o")
    """Metrics terms of the task whose value in the last step is shown; those that it lacks are left out."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 0, "env_id")
        require_at_least(self, 1, "samples")
