# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A fixed grid of rows and columns on the surface of any lumen, on which wall, contact and visual surface are based."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d, median_filter
from scipy.spatial import cKDTree

from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.meshing.conformal_map import ConformalMap
from arcgym.anatomy.meshing.level_curves import level_rings
from arcgym.anatomy.polyline import arc_lengths

_STEP = 0.0015
"""Distance of the level curves by which rows are placed [m]."""

_SECTORS = 48
"""Points of these level curves."""

_SMOOTHING = 0.006
"""Standard deviation of the smoothing of the distance of rows [m]: rows gather at folds, but not row by row."""

_OUTSIDE = 0.080
"""Length by which the centerline is continued in front of its first point [m]: the surface may begin there."""

_VERGE = 0.005, 0.015
"""Arc lengths between which the canal's radius is taken [m]."""

_WIDE = 0.8
"""Radius of the first row over that radius."""

_LAST_RADIUS = 0.55
"""Mean radius of the last ring before the dome of the cecum over the largest within :data:`_CECUM`."""

_AROUND = 3.0
"""Standard deviation, in rows and columns, of the surroundings from which points may stand out."""

_FARTHEST = 0.020
"""How far they may [m]."""

_CECUM = 0.060
"""Length of colon before its end in which the cecum's radius is taken [m]."""


@dataclass(frozen=True)
class LumenGrid:
    """Points on the surface of a lumen: rows from the anal verge to the cecal pole, columns round it.

    Seen along the colon, columns run like the fingers of the right hand whose thumb points ahead.
    """

    points: np.ndarray
    """Positions [m], shape (rows + dome rows, columns, 3); the last row is the pole, as often as there are columns."""
    angle: np.ndarray
    """Conformal angle of each point [rad], ascending along a row by a full turn, shape (rows + dome rows, columns)."""
    arc: np.ndarray
    """Arc length along the given centerline of each row [m], ascending, shape (rows + dome rows,)."""
    shape: GridShape
    """Numbers of rows and columns."""

    @property
    def tube(self) -> np.ndarray:
        """Points up to the last ring of the wall [m], shape (rows, columns, 3)."""
        return self.points[: self.shape.rows]


@dataclass(frozen=True)
class _Chart:
    """Level curves along the whole lumen; every field has one entry a curve."""

    level: np.ndarray
    travel: np.ndarray
    """Root-mean-square way of the points of a curve from the first one [m]."""
    arc: np.ndarray
    """Arc length along the centerline [m]."""
    radius: np.ndarray
    """Mean distance from its center [m]."""


def fit_grid(mapped: ConformalMap, path: np.ndarray, shape: GridShape | None = None) -> LumenGrid:
    """Lay the grid on a mapped surface.

    Args:
        mapped: Map of the surface, from before or at the anal verge to the cecal pole.
        path: Centerline from the anal verge to the pole [m], shape (n, 3).
        shape: Numbers of rows and columns.

    Raises:
        ValueError: Too few level curves go round the lumen: the ends are not those of a tube.
    """
    shape = shape or GridShape()
    chart = _chart(mapped, path)
    start = _first_row(chart)
    cecum = np.flatnonzero(chart.travel > chart.travel[-1] - _CECUM)
    wide = cecum[chart.radius[cecum] > _LAST_RADIUS * chart.radius[cecum].max()]
    last = chart.travel[wide[-1]]
    dome = np.linspace(last, chart.travel[-1], shape.dome_rows)[1:]
    travel = np.concatenate([np.linspace(start, last, shape.rows), dome])
    level = np.interp(travel, chart.travel, chart.level)
    points, angle, found = level_rings(mapped, level, shape.columns)
    points, angle = _oriented(_filled(points, found), _filled(angle, found))
    points = _without_spikes(points)
    points = np.concatenate([points, np.broadcast_to(points[-1].mean(0), (1, shape.columns, 3))])
    angle = np.concatenate([angle, angle[-1:]])
    arc = np.interp(travel, chart.travel, chart.arc)
    return LumenGrid(points, angle, _ascending(np.r_[arc, arc_lengths(path)[-1]]), shape)


def ring_centers(rings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the centroids by length of closed polygons, shape (n, 3), and their mean radii, shape (n,) [m]."""
    edge = np.roll(rings, -1, 1) - rings
    weight = np.linalg.norm(edge, axis=2)
    total = np.maximum(weight.sum(1), 1e-12)
    middle = rings + 0.5 * edge
    center = (middle * weight[..., None]).sum(1) / total[:, None]
    radius = (np.linalg.norm(middle - center[:, None], axis=2) * weight).sum(1) / total
    return center, radius


def _first_row(chart: _Chart) -> float:
    """Return where the first row lies [m]: at the verge, or where the lumen is wide, if a flat cap closes it there."""
    behind = (chart.arc > _VERGE[0]) & (chart.arc < _VERGE[1])
    wide = _WIDE * np.median(chart.radius[behind]) if behind.any() else 0.0
    first = int(np.argmax((chart.arc >= -_VERGE[0]) & (chart.radius >= wide)))
    return max(float(np.interp(0.0, chart.arc, chart.travel)), float(chart.travel[first]))


def _chart(mapped: ConformalMap, path: np.ndarray) -> _Chart:
    """Trace level curves a millimeter or two apart along the cut and measure them."""
    along = arc_lengths(mapped.points[mapped.cut])
    rising = np.maximum.accumulate(mapped.u[mapped.cut])
    level = np.unique(np.interp(np.arange(0.5 * _STEP, along[-1], _STEP), along, rising))
    level = level[(level > 1e-12) & (level < 1.0 - 1e-12)]
    rings, _, found = level_rings(mapped, level, _SECTORS)
    if found.mean() < 0.5 or found.sum() < 10:
        raise ValueError(
            f"Of {len(level)} level curves between the ends, {found.sum()} go round the lumen; expected nearly all."
            " Check that the ends are those of a single tube and that no loops are joined."
        )
    rings, level = rings[found], level[found]
    step = np.sqrt((np.diff(rings, axis=0) ** 2).sum(2).mean(1))
    travel = np.r_[0.0, np.cumsum(gaussian_filter1d(step, _SMOOTHING / _STEP, mode="nearest"))]
    return _Chart(level, travel, _arcs(rings, path), ring_centers(rings)[1])


def _arcs(rings: np.ndarray, path: np.ndarray) -> np.ndarray:
    """Return the arc length of the centerline at each ring: the median over the ring of that of the nearest point."""
    step = 0.001
    ahead = (path[0] - path[min(5, len(path) - 1)]) / np.linalg.norm(path[0] - path[min(5, len(path) - 1)])
    before = path[0] + np.arange(_OUTSIDE, 0.0, -step)[:, None] * ahead
    line = np.concatenate([before, path])
    arc = arc_lengths(line) - _OUTSIDE
    fine = np.arange(arc[0], arc[-1], step)
    _, near = cKDTree(np.stack([np.interp(fine, arc, line[:, k]) for k in range(3)], 1)).query(rings)
    middle = median_filter(np.median(fine[near], axis=1), 15, mode="nearest")
    return _ascending(gaussian_filter1d(_monotone(middle), 2.0, mode="nearest"))


def _monotone(values: np.ndarray) -> np.ndarray:
    """Return the mean of the least ascending function above and the largest below the values, shape kept."""
    return 0.5 * (np.maximum.accumulate(values) + np.minimum.accumulate(values[::-1])[::-1])


def _ascending(values: np.ndarray) -> np.ndarray:
    """Return ascending values made strictly so by less than a micrometer."""
    return _monotone(values) + 1e-9 * np.arange(len(values))


def _without_spikes(rings: np.ndarray) -> np.ndarray:
    """Draw points in that stand far out of their surroundings, where level curves run up narrow side pouches."""
    soft = gaussian_filter1d(gaussian_filter1d(rings, _AROUND, axis=0, mode="nearest"), _AROUND, axis=1, mode="wrap")
    way = rings - soft
    size = np.maximum(np.linalg.norm(way, axis=2, keepdims=True), 1e-9)
    return soft + way * np.minimum(1.0, _FARTHEST / size)


def _filled(rings: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Return values of rings, those that were not found interpolated from the nearest ones, shape kept."""
    at = np.arange(len(rings))
    flat = rings.reshape(len(rings), -1).copy()
    for k in np.flatnonzero(~found):
        after = int(np.clip(np.searchsorted(at[found], k), 1, found.sum() - 1))
        low, high = at[found][after - 1], at[found][after]
        share = np.clip((k - low) / (high - low), 0.0, 1.0)
        flat[k] = (1.0 - share) * rings[low].ravel() + share * rings[high].ravel()
    return flat.reshape(rings.shape)


def _oriented(rings: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rings and their angles, turned round if they are left-handed about the way ahead."""
    center = ring_centers(rings)[0]
    spoke = rings - center[:, None]
    area = np.cross(spoke, np.roll(spoke, -1, 1)).sum(1)
    forward = np.gradient(center, axis=0)
    if np.einsum("ij,ij->", area, forward) > 0:
        return rings, angle
    turned = np.roll(-angle[:, ::-1], 1, 1)
    turned[:, 1:] += 2 * np.pi
    return np.roll(rings[:, ::-1], 1, 1), turned
