# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From a voxel path to a smooth centreline that a wall can be swept along."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.cecum_fit import to_fitted_pole
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.openings import Opening, to_opening
from arcgym.anatomy.importing.polar import cast_rings
from arcgym.anatomy.segments import SEGMENTS

SPACING = 0.003
"""Distance of the points that are smoothed and moved [m]."""

_SMOOTHING = (0.004, 0.006, 0.009, 0.013, 0.018)
_SMOOTHING_SHARE = 0.65
_SECTORS = 24
_LARGEST_SHIFT = 0.005
_END_LENGTH = 0.03
_LENGTH_ROUNDS = 6
_LENGTH_SMOOTHING = 0.009
_CANAL = 0.015
_CANAL_BEND = (0.020, 0.055)
_CANAL_CURVATURE = 10.0


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


def centerd(
    grid: Grid, path: np.ndarray, find_pole: bool = True, openings: Sequence[Opening] = (), rounds: int = 6
) -> np.ndarray:
    """Smooths a path, moves it to the centroids of the lumen's cross-sections and goes on to the wall at both ends.

    Args:
        grid: The lumen.
        path: Way from the anus to the caecum [m], its ends a radius away from the wall, shape (n, 3).
        find_pole: Whether the caecal pole is not known and has to be found.
        openings: Holes of a surface; at an end, the way leads to the middle of its hole.
        rounds: How often it is moved.

    Returns:
        Points at equal distances from wall to wall [m], shape (n, 3).
    """
    points = smooth(resample(path, SPACING), 1.5)
    for _ in range(rounds):
        points = _centerd_once(grid, points)
    to_anus = to_opening(points[::-1], openings)
    points = (_to_the_wall(grid, points[::-1]) if to_anus is None else to_anus)[::-1]
    to_cecum = to_opening(points, openings)
    points = _to_the_wall(grid, points) if to_cecum is None else to_cecum
    points = to_fitted_pole(grid, points) if find_pole and to_cecum is None else points
    return resample(smooth(resample(points, SPACING), 1.5), SPACING)


def _centerd_once(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Returns points moved to the centroids and smoothed."""
    curve = plain_curve(points)
    s = np.linspace(0.0, curve.length, round(curve.length / SPACING) + 1)
    shift, radius = _centroid_shift(grid, curve, s)
    moved = curve.position(s) + gaussian_filter1d(shift, 2.0, axis=0, mode="nearest")
    return _smoothed_to_fit(moved, radius)


def _smoothed_to_fit(points: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Smooths over a share of the lumen's radius: where it is narrow, its bends may be as narrow."""
    level = np.interp(_SMOOTHING_SHARE * radius, _SMOOTHING, np.arange(len(_SMOOTHING)))
    out = np.zeros_like(points)
    for k, sigma in enumerate(_SMOOTHING):
        share = np.clip(1.0 - np.abs(level - k), 0.0, 1.0)[:, None]
        out += share * smooth(points, sigma / SPACING)
    return out


def _to_the_wall(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Goes straight on from the last point to the wall."""
    start = points[-1]
    end = _wall_ahead(grid, start, start - points[-1 - round(_END_LENGTH / SPACING)])
    if np.linalg.norm(end - start) < 0.5 * SPACING:
        return points
    return np.concatenate([points, resample(np.stack([start, end]), SPACING)[1:]])


def _wall_ahead(grid: Grid, start: np.ndarray, way: np.ndarray, step: float = 0.0005) -> np.ndarray:
    """Returns the last point of the lumen on a ray, at most 80 mm away."""
    ray = start + step * np.arange(160)[:, None] * way / max(float(np.linalg.norm(way)), 1e-9)
    inside = grid.sample(ray) > 0.5
    return ray[-1] if inside.all() else ray[max(int(inside.argmin()) - 1, 0)]


def _centroid_shift(grid: Grid, curve: Curve, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the way from the curve to the centroid of each cross-section [m], shape (n, 3), and the radius, (n,)."""
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


def relaxed(points: np.ndarray, half_width: np.ndarray, iterations: int = 400) -> np.ndarray:
    """Opens bends that are too sharp for the wall and moves loops apart where the wall would not fit between them.

    Lengths are kept: a bend is opened by moving it outwards, not by cutting its corner.

    Args:
        points: Centreline [m], shape (n, 3).
        half_width: Least radius of the outer wall at each point [m], shape (n,).
        iterations: Small steps to take; points that fit already hardly move.
    """
    out = points.copy()
    edge = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.r_[0.0, np.cumsum(edge)]
    need = half_width[:, None] + half_width[None]
    other = np.abs(arc[:, None] - arc[None]) > 2.2 * need
    a, b = np.nonzero(other & (np.linalg.norm(points[:, None] - points[None], axis=2) < need + 0.03))
    for _ in range(iterations):
        shift = _opened(out, half_width) + _pushed_apart(out, a, b, need[a, b])
        shift[[0, -1]] = 0.0
        if np.abs(shift).max() < 1e-6:
            break
        out += shift
        longer = out.copy()
        for _ in range(_LENGTH_ROUNDS):
            _restore_lengths(longer, edge)
        out += gaussian_filter1d(longer - out, _LENGTH_SMOOTHING / SPACING, axis=0, mode="nearest")
    return out


def _pushed_apart(points: np.ndarray, a: np.ndarray, b: np.ndarray, need: np.ndarray) -> np.ndarray:
    """Returns a smooth shift that takes points of other loops apart where they are nearer than ``need``."""
    shift = np.zeros_like(points)
    if not len(a):
        return shift
    offset = points[a] - points[b]
    distance = np.linalg.norm(offset, axis=1)
    push = np.clip(need - distance, 0.0, None) / np.maximum(distance, 1e-6)
    total = np.stack([np.bincount(a, push * offset[:, k], len(points)) for k in range(3)], 1)
    count = np.maximum(np.bincount(a, push > 0, len(points)), 1)[:, None]
    return 0.25 * gaussian_filter1d(total / count, 2.0, axis=0)


def _restore_lengths(points: np.ndarray, edge: np.ndarray) -> None:
    """Moves both ends of every edge so that it gets its length again; even edges first, then odd ones; in place."""
    for first in (0, 1):
        a, b = points[first:-1:2], points[first + 1 :: 2]
        offset = b - a
        length = np.linalg.norm(offset, axis=1, keepdims=True)
        half = 0.5 * offset * (1.0 - edge[first::2, None] / np.maximum(length, 1e-9))
        a += half
        b -= half


def _opened(points: np.ndarray, half_width: np.ndarray) -> np.ndarray:
    """Returns a shift towards the neighbours' middle where curvature times half width is above 0.8."""
    shift = np.zeros_like(points)
    shift[1:-1] = 0.5 * (points[:-2] + points[2:]) - points[1:-1]
    edge = 0.5 * np.linalg.norm(points[2:] - points[:-2], axis=1)
    curvature = 2.0 * np.linalg.norm(shift[1:-1], axis=1) / np.maximum(edge, 1e-6) ** 2
    shift[1:-1] *= np.clip(curvature * half_width[1:-1] / 0.8 - 1.0, 0.0, 0.8)[:, None]
    return shift


def with_upright_canal(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Turns the first centimetres until the anal canal rises along +Z, and puts the anal verge at the origin.

    Returns:
        The new points [m] and the angle by which the canal was turned [rad]; lengths are kept, and everything beyond
        4 cm, or 7 cm if it was turned far, only moves.
    """
    edge = np.diff(points, axis=0)
    length = np.linalg.norm(edge, axis=1)
    arc = np.cumsum(length) - 0.5 * length
    first = edge[arc < _CANAL].sum(0)
    upright, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [first])
    bend = float(np.clip(upright.magnitude() / _CANAL_CURVATURE, *_CANAL_BEND))
    share = np.clip((arc - _CANAL) / bend, 0.0, 1.0)
    fade = 1.0 - share * share * (3 - 2 * share)
    turned = Rotation.from_rotvec(fade[:, None] * upright.as_rotvec()).apply(edge)
    return np.concatenate([np.zeros((1, 3)), np.cumsum(turned, axis=0)]), float(upright.magnitude())
