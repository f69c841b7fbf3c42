# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated wall's two layers from the fine grid: smoothed, rings slid apart along the surface, given thickness."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d, map_coordinates
from scipy.optimize import isotonic_regression

from arcgym.anatomy.meshing.lumen_grid import LumenGrid, ring_centers

RING_DISTANCE = 0.0034
"""Distance along the outer layer that neighboring rings keep at every sector [m]; nearer ones jitter at rest."""

_LOW_PASS = 0.35
"""Standard deviation of the smoothing over the distance of the wall's vertices: sharper folds would alias into it."""

_NORMALS = 1.0
"""Standard deviation of the smoothing of the normals, likewise."""

_ROUNDS = 8
"""Number of times that rings are slid apart; after each, gaps whose straight distance is too short ask for more."""

_HELD = 1e6
"""Weight of the first and the last ring, which stay in place."""


def smooth_surface(grid: LumenGrid) -> tuple[np.ndarray, np.ndarray]:
    """Return the grid's tube smoothed to what the wall can follow, and its unit normals out of the lumen.

    Returns:
        Positions [m] and normals, at every row and at the columns of the wall's sectors, shape (rows, sectors, 3) each.
    """
    fine = grid.shape.visual
    soft = _blurred(grid.tube, _LOW_PASS * fine)
    along, around = np.gradient(soft, axis=0), np.roll(soft, -1, 1) - np.roll(soft, 1, 1)
    normal = np.cross(around, along)
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-12)
    normal = _blurred(normal, _NORMALS * fine)
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-12)
    return soft[:, ::fine], normal[:, ::fine]


def place_rings(points: np.ndarray, normals: np.ndarray, rings: int, thickness: float) -> np.ndarray:
    """Choose the row of each of the wall's vertices, so that neighboring rings keep apart in its outer layer.

    Vertices slide along their columns by the least way (isotonic regression along each); the first and the last ring
    stay.

    Args:
        points: Smoothed surface [m], shape (rows, sectors, 3).
        normals: Its normals, same shape.
        rings: Number of rings.
        thickness: Thickness of the wall [m].

    Returns:
        Fractional rows, ascending, shape (rings, sectors).
    """
    outer = points + thickness * normals
    length = np.concatenate([np.zeros((1, points.shape[1])), np.linalg.norm(np.diff(outer, axis=0), axis=2).cumsum(0)])
    even = np.repeat(np.linspace(0.0, len(points) - 1.0, rings)[:, None], points.shape[1], 1)
    gap = np.full((rings - 1, points.shape[1]), RING_DISTANCE)
    rows = even
    for k in range(_ROUNDS):
        slid = _slide(rows, length, gap)
        if k + 1 < _ROUNDS:
            shift = gaussian_filter(slid - even, (0.5, 0.7), mode=("nearest", "wrap"))
            shift[[0, -1]] = 0.0
            rows = np.maximum.accumulate(np.clip(even + shift, 0.0, len(points) - 1.0), axis=0)
            chord = np.linalg.norm(np.diff(sample_rows(outer, slid), axis=0), axis=2)
            gap = np.minimum(gap + 1.2 * np.maximum(RING_DISTANCE - chord, 0.0), 3.0 * RING_DISTANCE)
    return slid


def sample_rows(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Interpolate values at fractional rows of each column.

    Args:
        values: Shape (rows, sectors, 3).
        rows: Fractional rows, shape (rings, sectors).

    Returns:
        Shape (rings, sectors, 3).
    """
    column = np.broadcast_to(np.arange(rows.shape[1]), rows.shape)
    return np.stack([map_coordinates(values[..., k], [rows, column], order=1, mode="nearest") for k in range(3)], -1)


def wall_points(grid: LumenGrid, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the wall's two layers, the lumen side first.

    Args:
        grid: Grid on the surface of the lumen.
        thickness: Distance of the layers [m].

    Returns:
        Positions of layer, ring and sector [m], shape (2, rings, sectors, 3), and the row of the grid at which each
        vertex stands, shape (rings, sectors).
    """
    points, normals = smooth_surface(grid)
    rows = place_rings(points, normals, grid.shape.rings, thickness)
    inner, normal = sample_rows(points, rows), sample_rows(normals, rows)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    outer = inner + thickness * normal
    center = ring_centers(inner)[0]
    ahead = (center[-1] - center[-3]) / np.linalg.norm(center[-1] - center[-3])
    outer[-2:] += thickness * np.array([0.5, 1.0])[:, None, None] * ahead
    return np.stack([inner, outer]), rows


def _slide(rows: np.ndarray, length: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Move rows by the least way along their columns until neighbors are ``gap`` apart, shape kept."""
    out, at = np.empty_like(rows), np.arange(len(length))
    weight = np.r_[_HELD, np.ones(len(rows) - 2), _HELD]
    for j in range(rows.shape[1]):
        need = np.r_[0.0, np.cumsum(gap[:, j])]
        need *= min(1.0, 0.98 * length[-1, j] / need[-1])
        place = np.interp(rows[:, j], at, length[:, j]) - need
        out[:, j] = np.interp(isotonic_regression(place, weights=weight).x + need, length[:, j], at)
    return out


def _blurred(values: np.ndarray, sigma: float) -> np.ndarray:
    return gaussian_filter1d(gaussian_filter1d(values, sigma, axis=0, mode="nearest"), sigma, axis=1, mode="wrap")
