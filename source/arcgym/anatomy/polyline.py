# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Polylines: arc length, even spacing, smoothing, and edges that keep their lengths."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d


def arc_lengths(points: np.ndarray) -> np.ndarray:
    """Return the distance of each point from the first along the polyline, shape (n,), of points of shape (n, 3)."""
    return np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]


def resample(points: np.ndarray, spacing: float) -> np.ndarray:
    """Return points at equal distances of about ``spacing`` along a polyline, ends kept, shape (m, 3)."""
    arc = arc_lengths(points)
    even = np.linspace(0.0, arc[-1], max(2, round(arc[-1] / spacing) + 1))
    return np.stack([np.interp(even, arc, points[:, k]) for k in range(3)], 1)


def smooth(points: np.ndarray, sigma: float) -> np.ndarray:
    """Smooth a polyline without rounding its bends off (twicing, Tukey 1977); ends stay where they are.

    Args:
        points: Positions, shape (n, 3).
        sigma: Width of the Gaussian, in points.
    """
    pad = min(len(points) - 1, int(4 * sigma) + 1)
    once = _blur(points, sigma, pad)
    out = once + _blur(points - once, sigma, pad)
    out[[0, -1]] = points[[0, -1]]
    return out


def _blur(values: np.ndarray, sigma: float, pad: int) -> np.ndarray:
    padded = np.pad(values, ((pad, pad), (0, 0)), "reflect", reflect_type="odd")
    return gaussian_filter1d(padded, sigma, axis=0)[pad:-pad]


def restore_lengths(points: np.ndarray, edge: np.ndarray, fixed: np.ndarray, rounds: int) -> None:
    """Move both ends of every edge until it has its length, even edges first, then odd ones, in place.

    Points are held in two arrays meanwhile, one for even and one for odd ones: this is called thousands of times.

    Args:
        points: Positions [m], shape (3, n).
        edge: Length of each edge [m], shape (n - 1,).
        fixed: Where the first points are put before each round [m], shape (3, f).
        rounds: How often it is done.
    """
    sides = [np.ascontiguousarray(points[:, k::2]) for k in (0, 1)]
    even, odd = edge[0::2], edge[1::2]
    pairs = [
        (sides[0][:, : len(even)], sides[1][:, : len(even)], even),
        (sides[1][:, : len(odd)], sides[0][:, 1 : 1 + len(odd)], odd),
    ]
    for _ in range(rounds):
        for k, side in enumerate(sides):
            side[:, : fixed[:, k::2].shape[1]] = fixed[:, k::2]
        for a, b, wanted in pairs:
            half = b - a
            length = np.sqrt((half * half).sum(0))
            half *= 0.5
            half *= 1.0 - wanted / np.maximum(length, 1e-9)
            a += half
            b -= half
    for k, side in enumerate(sides):
        points[:, k::2] = side
