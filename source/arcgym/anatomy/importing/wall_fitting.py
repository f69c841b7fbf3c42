# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fit the simulated wall, a grid of rings and sectors, to the measured radii."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.polar import bounded
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.measures import tet_quality
from arcgym.anatomy.meshing.wall import build_wall, ring_arcs, wall_layers
from arcgym.anatomy.stage.types import WallMesh
from arcgym.anatomy.validation.mesh_checks import boundary_faces, find_crossings

_LEAST_QUALITY = 0.06
"""Quality of an element below which the wall is narrowed there; half more than a valid wall needs."""

_ITERATIONS = 120
"""Number of times that the wall is narrowed where it does not fit."""

_CROSSING_EVERY = 8
"""Iterations between two searches for self-crossings, which are slow."""

_CROSSING_WEIGHT = 2.0
"""How much more the wall is narrowed at a crossing than elsewhere."""

_SHRINK = 0.93
"""Radius after an iteration over that before, where the wall does not fit."""

_LEAST_RADIUS = 0.0074
"""Radius below which the wall is not narrowed [m]; a head has a radius of 6.6 mm."""

_BEND_LIMIT = 0.72
"""Curvature times radius of the outer wall on the inside of bends: leaves 3.5 mm between rings 12.5 mm apart."""


@dataclass(frozen=True)
class FittedWall:
    """A wall and how it differs from what was measured."""

    wall: WallMesh
    """The wall."""
    shift: np.ndarray
    """How far each inner vertex was moved outwards from the measured surface [m], shape (R, S)."""
    widened: float
    """Share of the inner vertices that were moved out to the least lumen radius."""
    narrowed: float
    """Share of them that were moved in by more than 1 mm, at bends and between loops."""


def fit_wall(curve: Curve, s: np.ndarray, radius: np.ndarray, settings: ImportSettings) -> FittedWall:
    """Fit the wall.

    Args:
        curve: Centreline.
        s: Arc length of the measured cross-sections [m], shape (n,).
        radius: Measured radii [m], shape (n, k).
        settings: Grid, thickness and bounds.

    Raises:
        ColonImportError: No wall without inverted elements was found.
    """
    arc = ring_arcs(curve.length, settings.ring_spacing)
    measured = _on_rings(s, radius, arc, settings.sectors)
    corner = 2.0 * np.pi / settings.sectors
    measured *= np.sqrt(corner / np.sin(corner))
    wanted = bounded(curve, arc, measured, settings.wall_thickness, _BEND_LIMIT)
    inner = np.maximum(wanted, settings.min_lumen_radius)
    wall = _build(curve, arc, inner, settings.wall_thickness)
    for turn in range(_ITERATIONS):
        tight = np.maximum(_too_near(wall, settings), _inverted(wall))
        if turn % _CROSSING_EVERY == 0 or not tight.any():
            tight = np.maximum(tight, _crossing(wall))
        if not tight.any():
            break
        soft = gaussian_filter(tight, (0.6, 0.8), mode=("nearest", "wrap"))
        floor = min(settings.min_lumen_radius, _LEAST_RADIUS)
        inner = np.maximum(inner * (1.0 - (1.0 - _SHRINK) * np.maximum(soft, tight)), floor)
        wall = _build(curve, arc, inner, settings.wall_thickness)
    quality = float(tet_quality(wall.points, wall.tets).min())
    if quality <= 0.0:
        at = float(arc[wall.ring[wall.tets[tet_quality(wall.points, wall.tets).argmin()]].min()])
        raise ColonImportError(
            f"The wall folds over itself {1e3 * at:.0f} mm from the anal verge (element quality {quality:.3f})",
            "Check the segmentation there, or pass a smaller --min-lumen or --wall-thickness.",
        )
    shift = inner - measured
    return FittedWall(wall, shift, float((shift > 1e-3).mean()), float((shift < -1e-3).mean()))


def _on_rings(s: np.ndarray, radius: np.ndarray, arc: np.ndarray, sectors: int) -> np.ndarray:
    """Average measured radii about each vertex of the ring grid: a coarse grid would turn sharp folds into spikes."""
    step, columns = s[1] - s[0], radius.shape[1]
    soft = gaussian_filter(
        radius, (0.35 * (arc[1] - arc[0]) / step, 0.35 * columns / sectors), mode=("nearest", "wrap")
    )
    at = np.stack([np.interp(arc, s, soft[:, k]) for k in range(columns)], 1)
    wanted = np.arange(sectors) * columns / sectors
    wrapped = np.concatenate([at, at[:, :1]], 1)
    low = np.floor(wanted).astype(int)
    share = wanted - low
    return (1 - share) * wrapped[:, low] + share * wrapped[:, low + 1]


def _build(curve: Curve, arc: np.ndarray, inner: np.ndarray, thickness: float) -> WallMesh:
    return build_wall(wall_layers(curve, arc, inner, thickness), curve.segment(arc), arc)


def _inverted(wall: WallMesh) -> np.ndarray:
    """Mark the grid vertices of badly shaped elements with 1, shape (R, S)."""
    bad = wall.tets[tet_quality(wall.points, wall.tets) < _LEAST_QUALITY]
    grid = wall.num_rings * wall.num_sectors
    mark = np.zeros(grid)
    mark[bad.ravel() % grid] = 1.0
    return mark.reshape(wall.num_rings, wall.num_sectors)


def _crossing(wall: WallMesh) -> np.ndarray:
    """Mark the grid vertices of edges that pass through faces, and of these faces, with 2, shape (R, S)."""
    grid = wall.num_rings * wall.num_sectors
    mark = np.zeros(grid)
    mark[find_crossings(wall.points, boundary_faces(wall.tets)).ravel() % grid] = _CROSSING_WEIGHT
    return mark.reshape(wall.num_rings, wall.num_sectors)


def _too_near(wall: WallMesh, settings: ImportSettings) -> np.ndarray:
    """Mark the grid vertices that are too near another loop with 1, shape (R, S)."""
    shape = (wall.num_rings, wall.num_sectors)
    outer = wall.points[wall.layer == 1].reshape(*shape, 3).astype(float)
    middle = outer.mean(1)
    width = np.linalg.norm(outer - middle[:, None], axis=2).max(1)
    tangent = np.gradient(middle, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    points, ring = outer.reshape(-1, 3), np.repeat(np.arange(shape[0]), shape[1])
    mark = np.zeros(len(points))
    pairs = cKDTree(points).query_pairs(1.6 * settings.ring_spacing, output_type="ndarray")
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    a, b = pairs.T
    other = np.abs(wall.ring_arc[ring[a]] - wall.ring_arc[ring[b]]) > 1.7 * (width[ring[a]] + width[ring[b]])
    a, b = a[other], b[other]
    near = np.linalg.norm(points[a] - points[b], axis=1) < settings.clearance
    offset = points[a] - middle[ring[b]]
    across = offset - np.einsum("ij,ij->i", offset, tangent[ring[b]])[:, None] * tangent[ring[b]]
    own = np.linalg.norm(points[b] - middle[ring[b]], axis=1)
    inside = np.linalg.norm(across, axis=1) < own + 0.5 * settings.clearance
    mark[a[near | inside]] = 1.0
    mark[b[near | inside]] = 1.0
    return mark.reshape(shape)
