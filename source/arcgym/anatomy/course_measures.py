# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures of a centerline by which colons are compared: how tight it bends, how much it turns, how wide it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.bends import acute_bends, turning

TIGHT = 0.025
"""Bend radius below which a stretch counts as tight [m]."""

_SPACING = 0.001
"""Distance of the points at which curvature is taken [m]."""

_SMOOTHING = 0.005
"""Standard deviation of the smoothing of the course [m], against the noise of centerlines from CT."""

_ENDS = 0.010
"""Length at either end that does not count [m]: the smoothing straightens it."""


@dataclass(frozen=True)
class CourseMeasures:
    """Measures of one centerline, smoothed by a Gaussian of 5 mm."""

    length: float
    """Length [m]."""
    bend_radius_p5: float
    """Bend radius that 5 % of the course is tighter than [m]."""
    bend_radius_least: float
    """Least bend radius [m]."""
    tight_share: float
    """Share of the course that bends tighter than 25 mm."""
    turning_p95: float
    """Turn of the tangent over 60 mm that 5 % of the course exceeds [rad]."""
    turning_most: float
    """Largest turn of the tangent over 60 mm [rad]."""
    total_turning: float
    """Curvature integrated along the course, over its length [rad/m]."""
    bend_over_lumen_p5: float
    """Bend radius over lumen radius that 5 % of the course is below; NaN without radii."""
    diameter: tuple[float, float, float]
    """Lumen diameter, 5th, 50th and 95th percentile [m]; NaN without radii."""
    acute_bends: int
    """Bends of more than 90 degrees within 60 mm."""


def measure_course(points: np.ndarray, radius: np.ndarray | None = None) -> CourseMeasures:
    """Measure a centerline.

    Args:
        points: Positions along it [m], shape (n, 3).
        radius: Lumen radius at them [m], shape (n,).
    """
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    s = np.arange(0.0, arc[-1], _SPACING)
    even = np.stack([np.interp(s, arc, points[:, k]) for k in range(3)], 1)
    soft = gaussian_filter1d(even, _SMOOTHING / _SPACING, axis=0, mode="nearest")
    first, second = np.gradient(soft, axis=0), np.gradient(np.gradient(soft, axis=0), axis=0)
    speed = np.linalg.norm(first, axis=1)
    curvature = np.linalg.norm(np.cross(first, second), axis=1) / np.maximum(speed, 1e-12) ** 3
    inside = (s > _ENDS) & (s < s[-1] - _ENDS)
    bend = 1.0 / np.maximum(curvature[inside], 1e-3)
    lumen = np.full(len(s), np.nan) if radius is None else np.interp(s, arc, radius)
    turn = turning(points, arc)[1]
    return CourseMeasures(
        length=float(arc[-1]),
        bend_radius_p5=float(np.percentile(bend, 5)),
        bend_radius_least=float(bend.min()),
        tight_share=float((bend < TIGHT).mean()),
        turning_p95=float(np.percentile(turn, 95)),
        turning_most=float(turn.max()),
        total_turning=float((curvature * speed)[inside].sum() / speed[inside].sum()),
        bend_over_lumen_p5=float(np.percentile(bend / lumen[inside], 5)),
        diameter=tuple(2.0 * np.percentile(lumen[inside], [5, 50, 95])),  # type: ignore[arg-type]
        acute_bends=len(acute_bends(points, arc)),
    )
