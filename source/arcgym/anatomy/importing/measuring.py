# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The lumen measured along its centerline: distance to the wall across the curve, and in the dome of the cecum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.bend_opening import open_bends
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.polar import cast, cast_rings, own_loop
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.smooth_centerline import plain_curve
from arcgym.anatomy.stage.types import Centerline

_MEASURE_SPACING = 0.001
"""Distance of the cross-sections [m]."""

_MEASURE_COLUMNS = 72
"""Rays in a cross-section."""

_AT_VERGE = 4
"""Cross-sections at the anal verge that lie in the end of the lumen; they are taken as wide as the next."""

_DOME_ROWS = 12
"""Rows of rays in the dome."""


@dataclass(frozen=True)
class Measured:
    """Centreline and radii in the patient's frame."""

    curve: Curve
    """Centreline."""
    s: np.ndarray
    """Arc length of the cross-sections [m], shape (n,)."""
    radius: np.ndarray
    """Distance to the wall [m], shape (n, k)."""
    dome_row: int
    """Cross-section at which the dome of the caecum begins."""
    dome: np.ndarray
    """Distance to the wall from its centre, from across the curve to along it [m], shape (m, k)."""


def measure(grid: Grid, points: np.ndarray, settings: ImportSettings) -> Measured:
    """Open the bends of a centerline for the wall and measure the lumen along it.

    Args:
        grid: The lumen in the patient's frame.
        points: Centerline from the anal verge to the caecal pole [m], evenly spaced, shape (n, 3).
        settings: Size of the wall, for which bends are opened.
    """
    half_width = settings.min_lumen_radius + settings.wall_thickness + 0.5 * settings.clearance
    curve = plain_curve(open_bends(points, np.full(len(points), half_width)))
    s = np.linspace(0.0, curve.length, round(curve.length / _MEASURE_SPACING) + 1)
    radius = own_loop(curve, s, cast_rings(grid, curve, s, _MEASURE_COLUMNS))
    radius[:_AT_VERGE] = radius[_AT_VERGE]
    reach = np.clip(np.median(radius[-60:-20]), 0.012, 0.035)
    row = int(np.searchsorted(s, curve.length - reach))
    theta = np.arange(_MEASURE_COLUMNS) * 2 * np.pi / _MEASURE_COLUMNS
    tangent, flat = curve.frame(s[row])[0], curve.outwards(s[row], theta)
    lift = np.linspace(0.0, 0.5 * np.pi, _DOME_ROWS)[:, None, None]
    directions = np.cos(lift) * flat + np.sin(lift) * tangent
    centers = np.repeat(curve.position(s[row])[None], _DOME_ROWS, 0)
    dome = np.minimum(cast(grid, centers, directions), 1.6 * reach)
    return Measured(curve, s, radius, row, dome)


def sample_centerline(curve: Curve, measured: Measured, spacing: float = 0.005) -> Centerline:
    """Return the stage's centerline, with the mean measured radius smoothed over 10 mm."""
    s = np.linspace(0.0, curve.length, round(curve.length / spacing) + 1)
    mean = gaussian_filter1d(measured.radius.mean(1), 10.0, mode="nearest")
    return Centerline(
        points=curve.position(s).astype(np.float32),
        arc=s.astype(np.float32),
        radius=np.interp(s, measured.s, mean).astype(np.float32),
        segment=curve.segment(s),
    )
