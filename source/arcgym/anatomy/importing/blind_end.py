# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The blind end of the cecum: the place of the lumen to which the way through it is longest.

A bulge of the wall beside the way is seldom at the end of the longest way, so that this place tells a pole from one; on
a round dome it moves about by one to two centimeters with the haustra, so that :mod:`cecum_fit` finds the pole itself.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.voxel_grid import Grid

_STEP = 0.003
"""Distance of points along the centerline [m]."""

_COARSE = 2
"""Voxels of the grid for one of the search."""

_BESIDE = 1.6
"""Distance from the centerline up to which the lumen is looked at, in its radii; the end may be twice as far ahead."""

_ALIKE = 0.003
"""How much shorter a way may be to count as one of the longest [m]; the ends of those are averaged."""

_TOGETHER = 0.020
"""Farthest that such ends lie from the farthest one [m]."""


def blind_end(grid: Grid, curve: Curve, start: float, radius: float) -> np.ndarray:
    """Return the place of the lumen beyond an arc length to which the way is longest [m], shape (3,).

    Args:
        grid: The lumen.
        curve: Centerline from the anus to the wall of the cecum.
        start: Arc length of its last part [m].
        radius: The lumen's radius there [m].
    """
    from skimage.graph import MCP_Geometric

    line = curve.position(np.append(np.arange(0.0, curve.length, _STEP), curve.length))
    first = int(start / _STEP)
    low, part = _box(grid, line[first:], 2.0 * _BESIDE * radius)
    index = np.argwhere(part)
    places = low + _COARSE * grid.spacing * index
    distance, nearest = cKDTree(line).query(places)
    ahead = nearest == len(line) - 1
    near = (nearest >= first) & (distance < np.where(ahead, 2.0, 1.0) * _BESIDE * radius)
    room = np.full(part.shape, -1.0)
    room[tuple(index[near].T)] = 1.0
    seed = index[near][np.linalg.norm(places[near] - line[first], axis=1).argmin()]
    way = _COARSE * grid.spacing * MCP_Geometric(room).find_costs([tuple(seed)])[0][tuple(index[near].T)]
    way = np.where(np.isfinite(way), way, 0.0)
    longest = places[near][way > way.max() - _ALIKE]
    return longest[np.linalg.norm(longest - places[near][way.argmax()], axis=1) < _TOGETHER].mean(0)


def _box(grid: Grid, line: np.ndarray, beside: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the first voxel's place [m] and the coarse lumen (X, Y, Z) of a box round a line."""
    low = np.maximum(np.floor(grid.index(line.min(0) - beside)).astype(int), 0)
    high = np.minimum(np.ceil(grid.index(line.max(0) + beside)).astype(int) + 1, grid.values.shape)
    box = tuple(slice(a, b, _COARSE) for a, b in zip(low, high, strict=True))
    return grid.points(low), grid.values[box] > 0.5
