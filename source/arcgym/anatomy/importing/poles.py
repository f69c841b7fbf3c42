# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Ends of a path on voxels: the blind end through the middle of the cecum, the open end off its corners.

:mod:`cecum_fit` finds the pole itself later, on the smooth centerline."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.polyline import resample
from arcgym.anatomy.voxel_grid import Grid

_BACK = 1.1
"""Distance from the ball's center at which the path is left for it, over the ball's radius."""

_LEAST_BACK = 0.015
"""Least such distance [m]."""

_LAST = 0.15
"""Length of the path's end that may be replaced [m]."""

_NEAR = 0.030
"""Largest distance of the ball's center from the path [m]."""

_ALIKE = 0.0015
"""How much smaller a ball may be to count as one of the largest [m]; their centers are averaged."""

_TIP = 0.020
"""Length of an open end over which its width is taken [m]."""


def lead_to_pole(clearance: Grid, path: np.ndarray, look: float) -> np.ndarray:
    """Lead the last part of a path through the middle of the lumen to its blind end, not into a corner.

    It ends at the center of the largest ball that fits in there; the pole is straight on.

    Args:
        clearance: Distance to the wall [m].
        path: Path to the blind end, evenly spaced [m], shape (n, 3).
        look: Length at the path's end in which the ball is sought [m].
    """
    step = float(np.linalg.norm(np.diff(path, axis=0), axis=1).mean())
    center, radius = _largest_ball(clearance, path[-max(2, round(look / step)) :])
    first = max(0, len(path) - round(_LAST / step))
    within = np.flatnonzero(np.linalg.norm(path[first:] - center, axis=1) < max(_BACK * radius, _LEAST_BACK))
    if not len(within) or first + within[0] < 10:
        return path
    return resample(np.concatenate([path[: first + within[0]], center[None]]), step)


def _largest_ball(clearance: Grid, path: np.ndarray) -> tuple[np.ndarray, float]:
    """Return center and radius [m] of the largest ball near a path, the mean of centers that are nearly as good."""
    reach = _NEAR / clearance.spacing
    index = clearance.index(path)
    low = np.maximum(np.floor(index.min(0) - reach).astype(int), 0)
    high = np.minimum(np.ceil(index.max(0) + reach).astype(int) + 1, clearance.values.shape)
    part = clearance.values[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
    voxels = np.argwhere(part > 0)
    points = clearance.points(voxels + low)
    distance, nearest = cKDTree(path).query(points)
    rays = path[nearest, None] + np.linspace(0.0, 1.0, 8)[:, None] * (points - path[nearest])[:, None]
    seen = (distance < _NEAR) & (clearance.sample(rays) > 0).all(1)
    room = np.where(seen, part[tuple(voxels.T)], 0.0)
    radius = float(room.max())
    alike = points[room > radius - _ALIKE]
    best = points[room.argmax()]
    return alike[np.linalg.norm(alike - best, axis=1) < 0.3 * radius].mean(0), radius


def trim_open_end(clearance: Grid, path: np.ndarray) -> np.ndarray:
    """Leave out the last of a path as far as its end is wide: an open end is cut off square and has corners."""
    step = float(np.linalg.norm(np.diff(path, axis=0), axis=1).mean())
    index = np.clip(np.rint(clearance.index(path)).astype(int), 0, np.array(clearance.values.shape) - 1)
    room = clearance.values[tuple(index.T)]
    back = round(float(room[-round(_TIP / step) :].max()) / step)
    return path[:-back] if 0 < back < len(path) - 10 else path
