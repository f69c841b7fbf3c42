# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The ends of a path: through the middle of the caecum to its pole, and off the corners of the open end."""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from .course import resample
from .grid import Grid

_BACK = 1.1
_LEAST_BACK = 0.015
_LAST = 0.15
_CLEAR_OF_START = 1.4
_LEAST_MORE = 0.6
_BAND = 0.004
_LEAST_SECTION = 0.2
_NEAR = 0.030
_ALIKE = 0.0015
_TIP = 0.012


def to_pole(clearance: Grid, path: np.ndarray, look: float) -> np.ndarray:
    """Leads the last part of a path through the middle of the lumen to its blind end, not into a corner.

    It goes through the centre of the largest ball that fits in, then through the middles of sections, bands of equal
    distance from the path so far, as far as there are any beyond the ball.

    Args:
        clearance: Distance to the wall [m].
        path: Way to the blind end, evenly spaced [m], shape (n, 3).
        look: Length at the path's end in which the ball is sought [m].
    """
    step = float(np.linalg.norm(np.diff(path, axis=0), axis=1).mean())
    center, radius = _largest_ball(clearance, path[-max(2, round(look / step)) :])
    first = max(0, len(path) - round(_LAST / step))
    within = np.flatnonzero(np.linalg.norm(path[first:] - center, axis=1) < max(_BACK * radius, _LEAST_BACK))
    if not len(within) or first + within[0] < 10:
        return path
    kept = resample(np.concatenate([path[: first + within[0]], center[None]]), step)
    bands = _bands(clearance, kept, _CLEAR_OF_START * radius, path[-1])
    if bands is None:
        return kept
    distance, points = bands
    number = (distance / _BAND).astype(int)
    count = np.bincount(number)
    use = np.flatnonzero(count > _LEAST_SECTION * np.pi * radius**2 * _BAND / clearance.spacing**3)
    if len(use) * _BAND < _LEAST_MORE * radius:
        return kept
    middle = np.stack([np.bincount(number, points[:, k])[use] / count[use] for k in range(3)], 1)
    return resample(np.concatenate([kept, middle]), step)


def _largest_ball(clearance: Grid, path: np.ndarray) -> tuple[np.ndarray, float]:
    """Returns centre and radius [m] of the largest ball near a path, the mean of centres that are nearly as good."""
    reach = _NEAR / clearance.spacing
    index = clearance.index(path)
    low = np.maximum(np.floor(index.min(0) - reach).astype(int), 0)
    high = np.minimum(np.ceil(index.max(0) + reach).astype(int) + 1, clearance.values.shape)
    part = clearance.values[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
    voxels = np.argwhere(part > 0)
    points = clearance.points(voxels + low)
    room = np.where(cKDTree(path).query(points)[0] < _NEAR, part[tuple(voxels.T)], 0.0)
    radius = float(room.max())
    alike = points[room > radius - _ALIKE]
    best = points[room.argmax()]
    return alike[np.linalg.norm(alike - best, axis=1) < 0.3 * radius].mean(0), radius


def _bands(clearance: Grid, kept: np.ndarray, beyond: float, tip: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Returns distance beyond the ball and position of the voxels ahead, towards the blind end, or None."""
    from skimage.graph import MCP_Geometric

    shape = np.array(clearance.values.shape)
    reach = float(np.linalg.norm(tip - kept[-1])) + 3 * beyond
    step = float(np.linalg.norm(kept[-1] - kept[-2]))
    seeds = np.clip(np.rint(clearance.index(kept[-round(_LAST / step) :])).astype(int), 0, shape - 1)
    half = int(reach / clearance.spacing) + 1
    low, high = np.maximum(seeds[-1] - half, 0), np.minimum(seeds[-1] + half + 1, shape)
    part = clearance.values[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] > 0
    near = seeds[((seeds >= low) & (seeds < high)).all(1)] - low
    near = near[part[tuple(near.T)]]
    distance, _ = MCP_Geometric(np.where(part, 1.0, -1.0)).find_costs([tuple(seed) for seed in near])
    distance = distance * clearance.spacing
    way = kept[-1] - kept[-8]
    ahead = np.argwhere(np.isfinite(distance) & (distance > beyond))
    ahead = ahead[(clearance.points(ahead + low) - kept[-1]) @ way > 0.0]
    if not len(ahead):
        return None
    marked = np.zeros(part.shape, bool)
    marked[tuple(ahead.T)] = True
    labels, _ = ndimage.label(marked)
    names = labels[tuple(ahead.T)]
    chosen = ahead[names == np.bincount(names).argmax()]
    return distance[tuple(chosen.T)] - beyond, clearance.points(chosen + low)


def off_the_wall(clearance: Grid, path: np.ndarray) -> np.ndarray:
    """Leaves out the last of a path as far as its end is wide: an open end is cut off square and has corners."""
    step = float(np.linalg.norm(np.diff(path, axis=0), axis=1).mean())
    index = np.clip(np.rint(clearance.index(path)).astype(int), 0, np.array(clearance.values.shape) - 1)
    room = clearance.values[tuple(index.T)]
    back = round(float(room[-round(_TIP / step) :].max()) / step)
    return path[:-back] if 0 < back < len(path) - 10 else path
