# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A smooth centerline from a path on voxels: moved to the middle of the lumen and led to the wall at both ends.

:mod:`path_search` finds the path.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.cecum_fit import lead_to_fitted_pole
from arcgym.anatomy.importing.openings import Opening, lead_to_opening
from arcgym.anatomy.importing.polar import cast_rings
from arcgym.anatomy.polyline import resample, smooth
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.voxel_grid import Grid

SPACING = 0.003
"""Distance of the points that are smoothed and moved [m]."""

_SMOOTHING = (0.004, 0.006, 0.009, 0.013, 0.018)
"""Standard deviations of the smoothing between which is interpolated [m]."""

_SMOOTHING_SHARE = 0.65
"""Standard deviation of the smoothing over the lumen's radius: two thirds; our choice."""

_SECTORS = 24
"""Rays round the lumen that give its centroid."""

_LARGEST_SHIFT = 0.005
"""Largest move to the centroid in one round [m]."""

_END_LENGTH = 0.03
"""Length of the path's end that gives its direction [m]."""


def plain_curve(points: np.ndarray) -> Curve:
    """Return the curve through points before its segments are known."""
    return Curve(points, np.linspace(0.0, 1.0, len(SEGMENTS) + 1)[1:])


def center_path(
    grid: Grid, path: np.ndarray, find_pole: bool = True, openings: Sequence[Opening] = (), rounds: int = 6
) -> np.ndarray:
    """Smooth a path, move it to the centroids of the lumen's cross-sections and lead it to the wall at both ends.

    Args:
        grid: The lumen.
        path: Path from the anus to the cecum [m], its ends a radius away from the wall, shape (n, 3).
        find_pole: Whether the cecal pole has to be found.
        openings: Holes of a surface; an end of the path is led to the middle of its hole.
        rounds: How often it is moved.

    Returns:
        Points at equal distances from wall to wall [m], shape (n, 3).
    """
    points = smooth(resample(path, SPACING), 1.5)
    for _ in range(rounds):
        points = _center_once(grid, points)
    to_anus = lead_to_opening(points[::-1], openings)
    points = (_to_the_wall(grid, points[::-1]) if to_anus is None else to_anus)[::-1]
    to_cecum = lead_to_opening(points, openings)
    points = _to_the_wall(grid, points) if to_cecum is None else to_cecum
    points = lead_to_fitted_pole(grid, points) if find_pole and to_cecum is None else points
    return resample(smooth(resample(points, SPACING), 1.5), SPACING)


def _center_once(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Return points moved to the centroids and smoothed."""
    curve = plain_curve(points)
    s = np.linspace(0.0, curve.length, round(curve.length / SPACING) + 1)
    shift, radius = _centroid_shift(grid, curve, s)
    moved = curve.position(s) + gaussian_filter1d(shift, 2.0, axis=0, mode="nearest")
    return _smoothed_to_fit(moved, radius)


def _smoothed_to_fit(points: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Smooth over a share of the lumen's radius: where it is narrow, its bends may be as narrow."""
    level = np.interp(_SMOOTHING_SHARE * radius, _SMOOTHING, np.arange(len(_SMOOTHING)))
    out = np.zeros_like(points)
    for k, sigma in enumerate(_SMOOTHING):
        share = np.clip(1.0 - np.abs(level - k), 0.0, 1.0)[:, None]
        out += share * smooth(points, sigma / SPACING)
    return out


def _to_the_wall(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Go straight on from the last point to the wall."""
    start = points[-1]
    end = _wall_ahead(grid, start, start - points[-1 - round(_END_LENGTH / SPACING)])
    if np.linalg.norm(end - start) < 0.5 * SPACING:
        return points
    return np.concatenate([points, resample(np.stack([start, end]), SPACING)[1:]])


def _wall_ahead(grid: Grid, start: np.ndarray, direction: np.ndarray, step: float = 0.0005) -> np.ndarray:
    """Return the last point of the lumen on a ray, at most 80 mm away."""
    ray = start + step * np.arange(160)[:, None] * direction / max(float(np.linalg.norm(direction)), 1e-9)
    inside = grid.sample(ray) > 0.5
    return ray[-1] if inside.all() else ray[max(int(inside.argmin()) - 1, 0)]


def _centroid_shift(grid: Grid, curve: Curve, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the shift from the curve to the centroid of each cross-section [m], shape (n, 3), and the radius, (n,)."""
    rays = cast_rings(grid, curve, s, _SECTORS)
    typical = gaussian_filter1d(np.median(rays, axis=1), 3.0, mode="nearest")
    radius = np.minimum(rays, 1.6 * typical[:, None])
    theta = np.arange(_SECTORS) * 2 * np.pi / _SECTORS
    _, normal, binormal = curve.frame(s)
    area = 0.5 * (radius**2).sum(1)
    x = (radius**3 * np.cos(theta)).sum(1) / (3 * np.maximum(area, 1e-9))
    y = (radius**3 * np.sin(theta)).sum(1) / (3 * np.maximum(area, 1e-9))
    shift = x[:, None] * normal + y[:, None] * binormal
    size = np.linalg.norm(shift, axis=1, keepdims=True)
    return shift * np.minimum(1.0, _LARGEST_SHIFT / np.maximum(size, 1e-9)), typical
