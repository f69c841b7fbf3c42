# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A smooth tube-like surface through a grid of points, and the distance of points from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.spatial import cKDTree

WRAP = 4
"""Columns by which the grid is continued around."""
SAMPLES = 8
"""Samples between two grid points among which the nearest is looked for first."""
FAR = 2.0e-3
"""Distance below which the distance's curvature is not resolved any more [m]; a shaft's axis stays farther off."""


@dataclass(frozen=True)
class Distance:
    """Signed distance of n points and its derivatives."""

    index: np.ndarray
    """Which of the points asked for, shape (n,)."""
    size: np.ndarray
    """Positive inside the lumen [m], shape (n,)."""
    normal: np.ndarray
    """Its gradient, inwards, shape (n, 3)."""
    turn: np.ndarray
    """Its Hessian [1/m], shape (n, 3, 3): (I - n n^T - J M^-1 J^T) / d, with the surface's slopes J and the Hessian M
    of half the squared distance by its coordinates."""
    place: np.ndarray
    """Grid coordinates of the nearest points, shape (n, 2)."""


class GridSurface:
    """Bicubic spline through rings of points; the lumen is inside the rings."""

    def __init__(self, points: np.ndarray):
        """Fit the spline.

        Args:
            points: Places on the surface, along and around, shape (S, A, 3) [m]; around they are periodic.
        """
        rings, sectors = points.shape[:2]
        around = np.arange(-WRAP, sectors + WRAP)
        wrapped = points[:, around % sectors]
        self._splines = [RectBivariateSpline(np.arange(rings), around, wrapped[..., k]) for k in range(3)]
        self._rings, self._sectors = rings, sectors
        s = np.linspace(0.0, rings - 1.0, SAMPLES * (rings - 1) + 1)
        a = np.arange(SAMPLES * sectors) / SAMPLES
        self._s, self._a = (grid.ravel() for grid in np.meshgrid(s, a, indexing="ij"))
        self._tree = cKDTree(self.at(self._s, self._a))
        self._centers = points.mean(axis=1)

    def at(self, s: np.ndarray, a: np.ndarray, ds: int = 0, da: int = 0) -> np.ndarray:
        """Return points, or derivatives, at grid coordinates along and around, shape (n, 3)."""
        return np.stack([spline.ev(s, a, dx=ds, dy=da) for spline in self._splines], axis=1)

    def rows(self, refine: int) -> np.ndarray:
        """Return grid coordinates along, ``refine`` from ring to ring, shape ((S - 1) * refine + 1,)."""
        return np.linspace(0.0, self._rings - 1.0, (self._rings - 1) * refine + 1)

    def sample(self, refine: int) -> np.ndarray:
        """Return points of the surface, ``refine`` times as many along and around [m], shape (S', A * refine, 3)."""
        s, a = np.meshgrid(self.rows(refine), np.arange(self._sectors * refine) / refine, indexing="ij")
        return self.at(s.ravel(), a.ravel()).reshape(*s.shape, 3)

    def project(self, points: np.ndarray, reach: float) -> Distance:
        """Return the distance of those points that are within ``reach`` [m] of the surface.

        ``reach`` is that to the nearest sample, which may be half a sample farther off than the surface.
        """
        found, nearest = self._tree.query(points, distance_upper_bound=reach)
        index = np.flatnonzero(np.isfinite(found))
        points, nearest = points[index], nearest[index]
        s, a = self._s[nearest].copy(), self._a[nearest].copy()
        for _ in range(3):
            off, x, y, metric = self._local(points, s, a)
            step = np.clip(_solve(_bounded(metric, x, y), off, x, y), -1.0 / SAMPLES, 1.0 / SAMPLES)
            s, a = np.clip(s - step[:, 0], 0.0, self._rings - 1.0), a - step[:, 1]
        off, x, y, metric = self._local(points, s, a)
        normal = np.cross(x, y)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        inside = self._centers[np.rint(s).astype(int)] - self.at(s, a)
        normal *= np.sign((normal * inside).sum(axis=1))[:, None]
        size = -(off * normal).sum(axis=1)
        slopes = np.stack([x, y], axis=2)
        moved = slopes @ np.linalg.solve(_bounded(metric, x, y), slopes.transpose(0, 2, 1))
        turn = np.eye(3) - normal[:, :, None] * normal[:, None, :] - moved
        turn /= np.maximum(size, FAR)[:, None, None]
        return Distance(index, size, normal, turn, np.stack([s, a % self._sectors], axis=1))

    def _local(self, points: np.ndarray, s: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return offset from the points, slopes along and around, and the Hessian of half the squared distance."""
        off = self.at(s, a) - points
        x, y = self.at(s, a, 1, 0), self.at(s, a, 0, 1)
        pp, qq = ((d * d + off * self.at(s, a, *order)).sum(1) for d, order in ((x, (2, 0)), (y, (0, 2))))
        pq = (x * y + off * self.at(s, a, 1, 1)).sum(1)
        return off, x, y, np.stack([np.stack([pp, pq], 1), np.stack([pq, qq], 1)], 1)


def _bounded(metric: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the Hessian kept positive: beyond a center of curvature the nearest point is not unique."""
    out = metric.copy()
    out[:, 0, 0] = np.maximum(metric[:, 0, 0], 0.1 * (x * x).sum(1))
    out[:, 1, 1] = np.maximum(metric[:, 1, 1], 0.1 * (y * y).sum(1))
    limit = 0.9 * np.sqrt(out[:, 0, 0] * out[:, 1, 1])
    out[:, 0, 1] = out[:, 1, 0] = np.clip(metric[:, 0, 1], -limit, limit)
    return out


def _solve(metric: np.ndarray, off: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the Newton step by the coordinates, shape (n, 2)."""
    slope = np.stack([(off * x).sum(1), (off * y).sum(1)], axis=1)
    return np.linalg.solve(metric, slope[:, :, None])[:, :, 0]
