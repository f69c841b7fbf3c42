# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw a scope's stiff head into a lumen where it has no room; importer and generator share it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.tubes import WALL, box_near, draw_tube
from arcgym.anatomy.validation.passage import HEAD_LENGTH, HEAD_RADIUS, Passage
from arcgym.anatomy.voxel_grid import Grid

_GROUP = 8
"""Heads that are drawn at once."""

LOOP = 0.045
"""How much farther along the lumen another loop is [m]."""


def draw_heads(
    out: Grid, lumen: Grid, line: np.ndarray, found: Passage, places: np.ndarray, radius: float, wall: float = WALL
) -> None:
    """Draw the heads at some places of a passage into a lumen, in place; a wall is left between two loops.

    Args:
        out: Lumen that they are drawn into.
        lumen: The lumen before, whose other loops are kept off.
        line: Its centerline [m], shape (n, 3).
        found: Heads in the poses in which they have most room.
        places: Which of them are drawn, ascending.
        radius: Radius with which they are drawn [m].
        wall: What is left between two loops [m].
    """
    half = 0.5 * HEAD_LENGTH - HEAD_RADIUS
    beads = np.linspace(-half, half, round(2 * half / out.spacing) + 1)[:, None]
    for part in _groups(places):
        axis = _beads(found, part, beads)
        keep_off = other_loops(lumen, line, axis, radius, found.arc[part])
        draw_tube(out, axis, np.full(len(axis), radius), keep_off, wall=wall)


def _groups(places: np.ndarray) -> list[np.ndarray]:
    """Return stretches of consecutive places, none longer than a group."""
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [run[k : k + _GROUP] for run in runs for k in range(0, len(run), _GROUP)]


def _beads(found: Passage, part: np.ndarray, beads: np.ndarray) -> np.ndarray:
    """Return points along the heads at some places and half-way to the next ones [m], shape (n, 3)."""
    after = np.minimum(part + 1, len(found.arc) - 1)
    axis = found.axis[part] + found.axis[after]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    middle = np.concatenate([found.middle[part], 0.5 * (found.middle[part] + found.middle[after])])
    return (middle[:, None] + beads * np.concatenate([found.axis[part], axis])[:, None]).reshape(-1, 3)


def other_loops(grid: Grid, line: np.ndarray, points: np.ndarray, radius: float, arc: np.ndarray) -> np.ndarray:
    """Return the lumen near points that belongs to other loops than a stretch of the centerline [m], shape (m, 3).

    Args:
        grid: The lumen.
        line: Its centerline [m], shape (n, 3).
        points: Where to look [m], shape (k, 3).
        radius: How far round them, apart from two walls [m].
        arc: Arc lengths of the stretch [m].
    """
    box = box_near(grid, points, radius + WALL + grid.spacing)
    lumen = grid.points(np.argwhere(grid.values[box] > 0.5) + [part.start for part in box])
    at = arc_lengths(line)[cKDTree(line).query(lumen)[1]]
    return lumen[(at < arc.min() - LOOP) | (at > arc.max() + LOOP)]
