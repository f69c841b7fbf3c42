# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From a voxel path to a smooth centreline that a wall can be swept along."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.segments import SEGMENTS

from .grid import Grid
from .polar import cast_rings

SPACING = 0.004
"""Distance of the points that are smoothed and moved [m]."""

_SMOOTHING = 0.008
_SECTORS = 24
_LARGEST_SHIFT = 0.004
_END_LENGTH = 0.03
_TRIM = 2.4
_CANAL = (0.012, 0.070)


def resample(points: np.ndarray, spacing: float) -> np.ndarray:
    """Returns points at equal distances along a polyline, ends kept."""
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    even = np.linspace(0.0, arc[-1], max(2, round(arc[-1] / spacing) + 1))
    return np.stack([np.interp(even, arc, points[:, k]) for k in range(3)], 1)


def smooth(points: np.ndarray, sigma: float) -> np.ndarray:
    """Smooths a polyline without rounding its bends off (twicing, Tukey 1977); ends stay where they are."""
    pad = min(len(points) - 1, int(4 * sigma) + 1)
    once = _blur(points, sigma, pad)
    out = once + _blur(points - once, sigma, pad)
    out[[0, -1]] = points[[0, -1]]
    return out


def _blur(values: np.ndarray, sigma: float, pad: int) -> np.ndarray:
    padded = np.pad(values, ((pad, pad), (0, 0)), "reflect", reflect_type="odd")
    return gaussian_filter1d(padded, sigma, axis=0)[pad:-pad]


def plain_curve(points: np.ndarray) -> Curve:
    """Returns the curve through points before its segments are known."""
    return Curve(points, np.linspace(0.0, 1.0, len(SEGMENTS) + 1)[1:])


def centred(grid: Grid, path: np.ndarray, rounds: int = 3) -> np.ndarray:
    """Smooths a path and moves it to the centroids of the lumen's cross-sections, shape (n, 3)."""
    points = smooth(resample(smooth(path, 4.0), SPACING), _SMOOTHING / SPACING)
    points = _both_to_the_wall(grid, _without_ends(grid, points))
    for _ in range(rounds):
        curve = plain_curve(points)
        s = np.linspace(0.0, curve.length, len(points))
        inner = np.clip(np.minimum(s, curve.length - s) / _END_LENGTH, 0.0, 1.0)
        shift = _centroid_shift(grid, curve, s) * inner[:, None]
        points = curve.position(s) + gaussian_filter1d(shift, 2.0, axis=0, mode="nearest")
        points = smooth(resample(points, SPACING), _SMOOTHING / SPACING)
    return resample(_both_to_the_wall(grid, points), SPACING)


def _both_to_the_wall(grid: Grid, points: np.ndarray) -> np.ndarray:
    return _to_the_wall(grid, _to_the_wall(grid, points)[::-1])[::-1]


def _without_ends(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Leaves out both ends as far as the lumen is wide there: the path may run into a corner."""
    curve = plain_curve(points)
    s = np.linspace(0.0, curve.length, len(points))
    radius = _median_radius(grid, curve, s)
    first = int(np.clip(_TRIM * np.median(radius[4:10]) / SPACING, 1, 15))
    last = int(np.clip(_TRIM * np.median(radius[-10:-4]) / SPACING, 1, 15))
    return points[first:-last]


def _to_the_wall(grid: Grid, points: np.ndarray, step: float = 0.0005) -> np.ndarray:
    """Goes straight on from the last point to the wall."""
    way = points[-1] - points[-1 - round(_END_LENGTH / SPACING)]
    way /= np.linalg.norm(way)
    ray = points[-1] + step * np.arange(1, 100)[:, None] * way
    inside = grid.sample(ray) > 0.5
    count = len(inside) if inside.all() else int(inside.argmin())
    return np.concatenate([points, ray[7:count:8]]) if count > 8 else points


def _centroid_shift(grid: Grid, curve: Curve, s: np.ndarray) -> np.ndarray:
    """Returns the way from the curve to the centroid of each cross-section [m], shape (n, 3)."""
    radius = np.minimum(cast_rings(grid, curve, s, _SECTORS), 1.6 * _median_radius(grid, curve, s)[:, None])
    theta = np.arange(_SECTORS) * 2 * np.pi / _SECTORS
    _, normal, binormal = curve.frame(s)
    area = 0.5 * (radius**2).sum(1)
    x = (radius**3 * np.cos(theta)).sum(1) / (3 * np.maximum(area, 1e-9))
    y = (radius**3 * np.sin(theta)).sum(1) / (3 * np.maximum(area, 1e-9))
    shift = x[:, None] * normal + y[:, None] * binormal
    size = np.linalg.norm(shift, axis=1, keepdims=True)
    return shift * np.minimum(1.0, _LARGEST_SHIFT / np.maximum(size, 1e-9))


def _median_radius(grid: Grid, curve: Curve, s: np.ndarray) -> np.ndarray:
    return gaussian_filter1d(np.median(cast_rings(grid, curve, s, _SECTORS), axis=1), 3.0, mode="nearest")


def relaxed(points: np.ndarray, half_width: np.ndarray, iterations: int = 300) -> np.ndarray:
    """Opens bends that are too sharp for the wall and moves loops apart where the wall would not fit between them.

    Args:
        points: Centreline [m], shape (n, 3).
        half_width: Least radius of the outer wall at each point [m], shape (n,).
        iterations: Small steps to take; points that fit already do not move.
    """
    out = points.copy()
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    need = half_width[:, None] + half_width[None]
    other = np.abs(arc[:, None] - arc[None]) > 2.2 * need
    a, b = np.nonzero(other & (np.linalg.norm(points[:, None] - points[None], axis=2) < need + 0.03))
    for _ in range(iterations):
        shift = _opened(out, half_width)
        if len(a):
            offset = out[a] - out[b]
            distance = np.linalg.norm(offset, axis=1)
            push = np.clip(need[a, b] - distance, 0.0, None) / np.maximum(distance, 1e-6)
            total = np.stack([np.bincount(a, push * offset[:, k], len(out)) for k in range(3)], 1)
            shift += 0.25 * gaussian_filter1d(
                total / np.maximum(np.bincount(a, push > 0, len(out)), 1)[:, None], 2.0, axis=0
            )
        shift[[0, -1]] = 0.0
        if np.abs(shift).max() < 1e-6:
            break
        out = out + shift
    return out


def _opened(points: np.ndarray, half_width: np.ndarray) -> np.ndarray:
    """Returns a shift towards the neighbours' middle where curvature times half width is above 0.8."""
    shift = np.zeros_like(points)
    shift[1:-1] = 0.5 * (points[:-2] + points[2:]) - points[1:-1]
    edge = 0.5 * np.linalg.norm(points[2:] - points[:-2], axis=1)
    curvature = 2.0 * np.linalg.norm(shift[1:-1], axis=1) / np.maximum(edge, 1e-6) ** 2
    shift[1:-1] *= np.clip(curvature * half_width[1:-1] / 0.8 - 1.0, 0.0, 0.8)[:, None]
    return shift


def with_upright_canal(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Turns the first centimetres so that the anal canal rises along +Z, and puts the anal verge at the origin.

    Returns:
        The new points [m] and the angle by which the canal was turned [rad]; lengths are kept, and everything beyond
        7 cm only moves.
    """
    edge = np.diff(points, axis=0)
    length = np.linalg.norm(edge, axis=1, keepdims=True)
    direction = edge / length
    arc = np.cumsum(length[:, 0]) - 0.5 * length[:, 0]
    share = np.clip((arc - _CANAL[0]) / (_CANAL[1] - _CANAL[0]), 0.0, 1.0)
    keep = (share * share * (3 - 2 * share))[:, None]
    turned = keep * direction + (1.0 - keep) * np.array([0.0, 0.0, 1.0])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-9)
    angle = float(np.arccos(np.clip(direction[arc < 0.03].mean(0)[2], -1.0, 1.0)))
    return np.concatenate([np.zeros((1, 3)), np.cumsum(length * turned, axis=0)]), angle
