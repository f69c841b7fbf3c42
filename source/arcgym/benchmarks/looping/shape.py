# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures of a loop in a scope's shaft, in numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ALPHA_TURNING = 300.0
"""Turning of the shaft from which a crossing counts as an alpha loop [deg]."""
VIEWS = np.radians(np.arange(-20.0, 21.0, 5.0))
"""Turns about the body axis from which a loop is looked at besides the front [rad], positive from the left side."""


@dataclass(frozen=True)
class Loop:
    """Shape of a shaft."""

    turning: float
    """Sum of the angles between neighboring parts, the integral of the absolute curvature [deg]."""
    writhe: float
    """Gauss's double integral over the shaft: 0 for a plane curve, about -1 or 1 for a tight loop that crosses itself.
    """
    crossings: int
    """Places where the shaft crosses itself, seen from the front."""
    views: float
    """Share of the :data:`VIEWS` in which it crosses itself: how far from edge-on the loop is seen."""

    @property
    def alpha(self) -> bool:
        """Whether the shaft crosses itself after turning by more than :data:`ALPHA_TURNING`."""
        return self.crossings > 0 and self.turning > ALPHA_TURNING


def measure_loop(points: np.ndarray) -> Loop:
    """Return the loop of a shaft through ``points`` [m], shape (n, 3)."""
    seen = [crossings(from_front(points, azimuth)) for azimuth in VIEWS]
    return Loop(turning(points), writhe(points), crossings(from_front(points)), float(np.mean(np.array(seen) > 0)))


def from_front(points: np.ndarray, azimuth: float = 0.0) -> np.ndarray:
    """Return the points as an endoscope imager in front of the patient shows them, or one beside it, (n, 2)."""
    return np.stack([points[:, 0] * np.cos(azimuth) + points[:, 1] * np.sin(azimuth), points[:, 2]], axis=1)


def turning(points: np.ndarray) -> float:
    """Return the sum of the angles between neighboring segments [deg]."""
    along = np.diff(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    cosine = (along[1:] * along[:-1]).sum(axis=1).clip(-1.0, 1.0)
    return float(np.degrees(np.arccos(cosine)).sum())


def writhe(points: np.ndarray) -> float:
    """Return the Gauss integral by the midpoint rule without neighbors, which add nothing to a smooth curve."""
    along = np.diff(points, axis=0)
    apart = (points[1:] + points[:-1])[:, None] / 2.0 - (points[1:] + points[:-1])[None] / 2.0
    distance = np.linalg.norm(apart, axis=2)
    count = len(along)
    near = np.abs(np.subtract.outer(np.arange(count), np.arange(count))) < 2
    triple = np.einsum("abi,abi->ab", np.cross(along[:, None], along[None]), apart)
    return float(np.where(near, 0.0, triple / np.where(near, 1.0, distance) ** 3).sum() / (4.0 * np.pi))


def crossings(plane: np.ndarray) -> int:
    """Return the pairs of segments of a plane curve, shape (n, 2), that cross each other."""
    start, end = plane[:-1], plane[1:]

    def left(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Return the sign of the turn from a over b to c, for all pairs."""
        u, v = b - a, c - a
        return np.sign(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    a, b, c, d = start[:, None], end[:, None], start[None], end[None]
    cross = (left(a, b, c) * left(a, b, d) < 0) & (left(c, d, a) * left(c, d, b) < 0)
    return int(np.triu(cross, k=2).sum())
