# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Distance from the centreline to the wall in every direction, by rays through the grid."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d, median_filter
from scipy.spatial import cKDTree

from arcgym.anatomy.blending import soft_limit
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.grid import Grid

REACH = 0.060
"""Length of the rays [m]."""

_STEP = 0.0006
"""Distance of the samples along a ray [m]."""

_BEND_LIMIT = 0.85
"""Largest radius over the bend's on its inside."""

_CHUNK = 200
"""Cross-sections that are cast at once, which bounds the memory."""


def cast_rings(grid: Grid, curve: Curve, s: np.ndarray, sectors: int) -> np.ndarray:
    """Cast rays in the plane across the curve at each ``s``.

    Returns:
        Distance to where the lumen ends [m], shape (n, sectors); sector j stands at ``2 pi j / sectors``.
    """
    theta = np.arange(sectors) * 2 * np.pi / sectors
    return cast(grid, curve.position(s), curve.outwards(s[:, None], theta))


def cast(grid: Grid, centers: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Cast rays from centres, shape (n, 3), in unit directions, shape (n, k, 3); returns lengths [m], (n, k)."""
    rho = _STEP * np.arange(round(REACH / _STEP) + 1)
    out = np.zeros(directions.shape[:2])
    for start in range(0, len(centers), _CHUNK):
        part = slice(start, start + _CHUNK)
        points = centers[part, None, None] + rho[:, None] * directions[part, :, None]
        value = grid.sample(points)
        outside = value < 0.5
        first = np.where(outside.any(-1), outside.argmax(-1), len(rho) - 1)
        before = np.maximum(first - 1, 0)
        high = np.take_along_axis(value, before[..., None], -1)[..., 0]
        low = np.take_along_axis(value, first[..., None], -1)[..., 0]
        share = np.clip((high - 0.5) / np.maximum(high - low, 1e-6), 0.0, 1.0)
        out[part] = _STEP * (before + np.where(first > 0, share, 0.0))
    return out


def bounded(
    curve: Curve, s: np.ndarray, radius: np.ndarray, wall: float = 0.0, share: float = _BEND_LIMIT
) -> np.ndarray:
    """Limit radii softly on the inside of bends, where a swept surface would fold over; shape (n, sectors)."""
    theta = np.arange(radius.shape[1]) * 2 * np.pi / radius.shape[1]
    _, normal, binormal = curve.frame(s)
    bend = curve.interpolate(s, curve.curvature_vector)
    across = np.stack([(bend * normal).sum(1), (bend * binormal).sum(1)], 1)
    towards = across[:, :1] * np.cos(theta) + across[:, 1:] * np.sin(theta)
    limit = np.where(towards > 1e-3, share / np.maximum(towards, 1e-3) - wall, 1.0)
    return soft_limit(radius, limit)


def own_loop(curve: Curve, s: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Cut rays that run through a window or a leak: at the border to a neighbouring loop, and where they stick out.

    The border between two loops is the power plane of their mean circles, moved out by a tenth.
    """
    typical = gaussian_filter1d(np.median(radius, axis=1), 8.0 * len(s) / 1000, mode="nearest")
    out = np.minimum(radius, _loop_border(curve, s, typical, radius.shape[1]))
    closed = np.pad(out, ((0, 0), (4, 4)), "wrap")
    sticking = median_filter(closed, size=(9, 5), mode="nearest")[:, 4:-4]
    return np.minimum(out, np.maximum(1.5 * sticking + 0.004, 0.0))


def _loop_border(curve: Curve, s: np.ndarray, typical: np.ndarray, sectors: int) -> np.ndarray:
    """Return the distance along each ray to the border with other loops [m], shape (n, sectors)."""
    centers, theta = curve.position(s), np.arange(sectors) * 2 * np.pi / sectors
    _, normal, binormal = curve.frame(s)
    limit = np.full((len(s), sectors), REACH)
    pairs = cKDTree(centers).query_pairs(2 * REACH, output_type="ndarray")
    pairs = pairs[(pairs[:, 0] % 2 == 0) | (pairs[:, 1] % 2 == 0)]
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    offset = centers[pairs[:, 1]] - centers[pairs[:, 0]]
    far = np.abs(s[pairs[:, 0]] - s[pairs[:, 1]]) > 1.7 * (typical[pairs[:, 0]] + typical[pairs[:, 1]]) + 0.01
    facing = np.abs(np.einsum("ij,ij->i", offset, curve.frame(s)[0][pairs[:, 0]])) < 0.4 * np.linalg.norm(
        offset, axis=1
    )
    pairs, offset = pairs[far & facing], offset[far & facing]
    own, other = pairs.T
    power = 0.5 * ((offset**2).sum(1) + typical[own] ** 2 - typical[other] ** 2)
    for j, angle in enumerate(theta):
        along = np.einsum("ij,ij->i", offset, np.cos(angle) * normal[own] + np.sin(angle) * binormal[own])
        hit = along > 1e-3
        np.minimum.at(limit[:, j], own[hit], np.maximum(1.1 * power[hit] / along[hit], 0.0))
    return limit
