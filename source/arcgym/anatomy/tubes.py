# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tubes drawn into a lumen, with a wall left between them and other loops."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.voxel_grid import Grid

_MARGIN = 0.006
"""Room that is left round the lumen [m]."""

WALL = 0.004
"""What is left between a tube and another loop [m]: two walls."""


def padded_for(grid: Grid, points: np.ndarray, radius: float) -> Grid:
    """Return a copy of a grid with room for balls of a radius [m] round points [m], shape (n, 3)."""
    reach = radius + _MARGIN
    low = np.minimum(np.floor(grid.index(points.min(0) - reach)).astype(int), 0)
    high = np.maximum(np.ceil(grid.index(points.max(0) + reach)).astype(int) + 1, grid.values.shape)
    pad = [(int(-a), int(b - size)) for a, b, size in zip(low, high, grid.values.shape, strict=True)]
    return Grid(np.pad(grid.values, pad), grid.origin + grid.spacing * low, grid.spacing)


def box_near(grid: Grid, points: np.ndarray, reach: float) -> tuple[slice, ...]:
    """Return the part of a grid that lies within a reach [m] of points [m], shape (n, 3), or a little farther."""
    low = np.maximum(np.floor(grid.index(points.min(0) - reach)).astype(int), 0)
    high = np.minimum(np.ceil(grid.index(points.max(0) + reach)).astype(int) + 1, grid.values.shape)
    return tuple(slice(int(a), int(max(a, b))) for a, b in zip(low, high, strict=True))


def draw_tube(
    grid: Grid,
    line: np.ndarray,
    radius: np.ndarray,
    keep_off: np.ndarray | None = None,
    flat_start: bool = False,
    wall: float = WALL,
) -> None:
    """Add a tube to a lumen, in place; its surface lies between voxels.

    Args:
        grid: The lumen.
        line: Middle of the tube, points no farther apart than two voxels [m], shape (n, 3).
        radius: Its radius there [m], shape (n,).
        keep_off: Lumen of other loops that a wall is left to [m], shape (m, 3).
        flat_start: Whether it ends square at its first point, not in a ball.
        wall: What is left between it and them [m].
    """
    reach = float(radius.max()) + 2 * grid.spacing
    box = box_near(grid, line, reach)
    shape = grid.values[box].shape
    points = grid.points(np.indices(shape).reshape(3, -1).T + [part.start for part in box])
    distance, nearest = cKDTree(line).query(points, distance_upper_bound=reach)
    near = np.isfinite(distance)
    depth = np.full(len(points), -np.inf)
    depth[near] = radius[nearest[near]] - distance[near]
    if flat_start:
        depth = np.minimum(depth, (points - line[0]) @ (line[1] - line[0]) / np.linalg.norm(line[1] - line[0]))
    value = np.clip(0.5 + depth / grid.spacing, 0.0, 1.0)
    if keep_off is not None and len(keep_off):
        drawn = np.flatnonzero(value > 0.0)
        value[drawn[cKDTree(keep_off).query(points[drawn])[0] < wall]] = 0.0
    grid.values[box] = np.maximum(grid.values[box], value.reshape(shape))
