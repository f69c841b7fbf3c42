# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Open bends that are too sharp for the wall, and move loops apart where it has no room.

The generator's :mod:`arcgym.anatomy.generator.relaxation` makes a course from control points instead.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.importing.smooth_centerline import SPACING
from arcgym.anatomy.polyline import restore_lengths

_LENGTH_ROUNDS = 6
"""Rounds in which edges get their lengths back after each step."""

_LENGTH_SMOOTHING = 0.009
"""Standard deviation of the smoothing of that correction [m]."""

_LARGEST_CURVATURE = 0.8
"""Curvature times half width above which a bend is opened; at 1 the wall would fold over."""


def open_bends(points: np.ndarray, half_width: np.ndarray, iterations: int = 400) -> np.ndarray:
    """Open bends that are too sharp for the wall and move loops apart where the wall would not fit between them.

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
        shift = _unbend(out, half_width) + _push_apart(out, a, b, need[a, b])
        shift[[0, -1]] = 0.0
        if np.abs(shift).max() < 1e-6:
            break
        out += shift
        longer = out.copy()
        for _ in range(_LENGTH_ROUNDS):
            restore_lengths(longer, edge)
        out += gaussian_filter1d(longer - out, _LENGTH_SMOOTHING / SPACING, axis=0, mode="nearest")
    return out


def _push_apart(points: np.ndarray, a: np.ndarray, b: np.ndarray, need: np.ndarray) -> np.ndarray:
    """Return a smooth shift that takes points of other loops apart where they are nearer than ``need``."""
    shift = np.zeros_like(points)
    if not len(a):
        return shift
    offset = points[a] - points[b]
    distance = np.linalg.norm(offset, axis=1)
    push = np.clip(need - distance, 0.0, None) / np.maximum(distance, 1e-6)
    total = np.stack([np.bincount(a, push * offset[:, k], len(points)) for k in range(3)], 1)
    count = np.maximum(np.bincount(a, push > 0, len(points)), 1)[:, None]
    return 0.25 * gaussian_filter1d(total / count, 2.0, axis=0)


def _unbend(points: np.ndarray, half_width: np.ndarray) -> np.ndarray:
    """Return a shift towards the neighbours' middle where curvature times half width is above 0.8."""
    shift = np.zeros_like(points)
    shift[1:-1] = 0.5 * (points[:-2] + points[2:]) - points[1:-1]
    edge = 0.5 * np.linalg.norm(points[2:] - points[:-2], axis=1)
    curvature = 2.0 * np.linalg.norm(shift[1:-1], axis=1) / np.maximum(edge, 1e-6) ** 2
    shift[1:-1] *= np.clip(curvature * half_width[1:-1] / _LARGEST_CURVATURE - 1.0, 0.0, 0.8)[:, None]
    return shift
