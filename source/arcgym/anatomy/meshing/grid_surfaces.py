# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact and visual surfaces from a lumen's grid, carried by the wall's inner vertices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.measures import face_normals
from arcgym.anatomy.meshing.coarse_wall import sample_rows
from arcgym.anatomy.meshing.lumen_grid import LumenGrid, ring_centers
from arcgym.anatomy.meshing.refine import refine
from arcgym.anatomy.meshing.surface_grid import dome_texture, grid_triangles, smooth_normals, tube_texture
from arcgym.anatomy.stage.types import ContactSurface, VisualMesh

_SMALLEST_FACE = 1e-12
"""Least double area of a triangle of a visual surface [m^2]; those at the pole have none."""


@dataclass(frozen=True)
class Detail:
    """What is shaped finer than the grid, such as polyps."""

    near: Callable[[np.ndarray, int], np.ndarray]
    """Says of points, shape (n, 3), and a level from 0, which to refine, shape (n,), bool."""
    shape: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    """Returns the points moved, shape (n, 3), and their tint, shape (n,)."""
    touched: Callable[[np.ndarray], np.ndarray] | None = None
    """Returns points of wall and contact surface moved, shape (n, 3); None leaves both as they are."""


def contact_surface(grid: LumenGrid, wall_rows: np.ndarray, detail: Detail | None = None) -> ContactSurface:
    """Return the surface that the scope touches: rows and columns that divide the wall's cells evenly.

    Row ``k * shape.contact`` and column ``j * shape.contact`` stand where the wall's ring k and sector j do, before
    smoothing; what is between belongs to that cell of the wall.

    Args:
        grid: Grid on the surface of the lumen.
        wall_rows: Row of the grid at which each vertex of the wall stands, shape (rings, sectors).
        detail: Moves points, see :attr:`Detail.touched`.
    """
    shape, parts = grid.shape, grid.shape.contact
    step = shape.visual // parts
    rows = _between(wall_rows, parts)
    tube = sample_rows(grid.tube[:, ::step], rows)
    dome = grid.points[shape.rows - 1 + step :: step, ::step]
    points = np.concatenate([tube, dome])
    if detail and detail.touched:
        points = detail.touched(points.reshape(-1, 3)).reshape(points.shape)
    count, columns = points.shape[:2]
    indices, weights = _carriers(
        np.repeat(np.minimum(np.arange(count) / parts, shape.rings - 1.0)[:, None], columns, 1).ravel(),
        np.tile(np.arange(columns) / parts, count),
        shape,
    )
    return ContactSurface(points.reshape(-1, 3).astype(np.float32), columns, indices, weights)


def visual_surface(
    grid: LumenGrid,
    wall_rows: np.ndarray,
    bounds: Mapping[str, tuple[float, float]],
    step: int = 1,
    detail: Detail | None = None,
    refinements: int = 0,
) -> VisualMesh:
    """Return a surface for the camera, on every ``step``-th row and column of the grid.

    The seam of the texture at column 0 and the edge of the dome have their vertices twice, once for each chart.

    Args:
        grid: Grid on the surface of the lumen.
        wall_rows: Row of the grid at which each vertex of the wall stands, shape (rings, sectors).
        bounds: Arc length where each segment starts and ends [m], for the texture.
        step: Rows and columns of the grid for each of the surface; a divisor of ``grid.shape.visual``.
        detail: Shapes finer than the grid.
        refinements: How often triangles near them are split into four.
    """
    places, faces = _charts(grid, step)
    for level in range(refinements if detail else 0):
        near = detail.near(_positions(grid, places), level)  # type: ignore[union-attr]
        places, faces = refine(places, faces, near[faces].any(1))
    points, tint = _positions(grid, places), np.zeros(len(places))
    if detail:
        points, tint = detail.shape(points)
    points = points.astype(np.float32)
    faces = faces[np.linalg.norm(face_normals(points, faces), axis=1) > _SMALLEST_FACE].astype(np.int32)
    indices, weights = _carriers(*_wall_places(places, wall_rows, grid.shape), grid.shape)
    return VisualMesh(
        points=points,
        faces=faces,
        normals=smooth_normals(points, faces),
        uv=_texture(grid, places, bounds).astype(np.float32),
        tint=tint.astype(np.float32),
        skin_indices=indices,
        skin_weights=weights,
    )


def _between(wall_rows: np.ndarray, parts: int) -> np.ndarray:
    """Divide the cells between the wall's vertices evenly, shape ((rings - 1) parts + 1, sectors parts)."""
    rings, sectors = wall_rows.shape
    at = np.linspace(0.0, rings - 1.0, (rings - 1) * parts + 1)
    return _interpolated(wall_rows, at, np.arange(sectors * parts) / parts)


def _interpolated(values: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Interpolate values at fractional rows and columns, which close round, shape (len(rows), len(columns))."""
    return map_coordinates(values, np.meshgrid(rows, columns, indexing="ij"), order=1, mode="grid-wrap")


def _charts(grid: LumenGrid, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Return row, column and a mark of the dome of each vertex, shape (n, 3), and triangles of tube and dome."""
    shape = grid.shape
    columns = np.arange(0, shape.columns + 1, step)
    parts, faces, offset = [], [], 0
    for first, last, mark in ((0, shape.rows, 0.0), (shape.rows - 1, len(grid.points), 1.0)):
        rows = np.arange(first, last, step)
        row, column = np.meshgrid(rows, columns, indexing="ij")
        parts.append(np.stack([row, column, np.full(row.shape, mark)], -1).reshape(-1, 3))
        faces.append(grid_triangles(len(rows), len(columns)) + offset)
        offset += row.size
    return np.concatenate(parts).astype(float), np.concatenate(faces)


def _positions(grid: LumenGrid, places: np.ndarray) -> np.ndarray:
    """Interpolate the grid at fractional rows and columns [m], shape (n, 3)."""
    closed = np.concatenate([grid.points, grid.points[:, :1]], 1)
    at = places[:, :2].T
    return np.stack([map_coordinates(closed[..., k], at, order=1, mode="nearest") for k in range(3)], 1)


def _wall_places(places: np.ndarray, wall_rows: np.ndarray, shape: GridShape) -> tuple[np.ndarray, np.ndarray]:
    """Return the fractional ring and sector of the wall at which each vertex lies, shape (n,) each."""
    at = np.arange(shape.rings, dtype=float)
    around = np.arange(shape.columns + 1) / shape.visual
    columns = _interpolated(wall_rows, at, around % shape.sectors)
    rows = np.arange(shape.rows + shape.dome_rows, dtype=float)
    ring = np.stack([np.interp(rows, columns[:, k], at) for k in range(len(around))], 1)
    return map_coordinates(ring, places[:, :2].T, order=1, mode="nearest"), places[:, 1] / shape.visual


def _carriers(ring: np.ndarray, sector: np.ndarray, shape: GridShape) -> tuple[np.ndarray, np.ndarray]:
    """Return bilinear carriers among the wall's inner vertices, shape (n, 4) int32, and weights, (n, 4) float32."""
    row = np.minimum(ring.astype(int), shape.rings - 2)
    column = np.floor(sector).astype(int)
    along, around = ring - row, sector - column
    column, after = column % shape.sectors, (column + 1) % shape.sectors
    low, high = row * shape.sectors, (row + 1) * shape.sectors
    weights = [(1 - along) * (1 - around), along * (1 - around), along * around, (1 - along) * around]
    indices = [low + column, high + column, high + after, low + after]
    return np.stack(indices, 1).astype(np.int32), np.stack(weights, 1).astype(np.float32)


def _texture(grid: LumenGrid, places: np.ndarray, bounds: Mapping[str, tuple[float, float]]) -> np.ndarray:
    """Return u round the lumen and v along it, shape (n, 2)."""
    closed = np.concatenate([grid.angle, grid.angle[:, :1] + 2 * np.pi], 1)
    theta = map_coordinates(closed, places[:, :2].T, order=1, mode="nearest")
    s = np.interp(places[:, 0], np.arange(len(grid.arc)), grid.arc)
    uv = tube_texture(s, theta, bounds)
    dome = places[:, 2] > 0.5
    rows = grid.points[grid.shape.rows - 1 :]
    step = np.linalg.norm(np.diff(rows, axis=0), axis=2).mean(1)
    meridian = np.r_[np.cumsum(step[::-1])[::-1], 0.0]
    from_rim = places[dome, 0] - (grid.shape.rows - 1)
    rim = float(ring_centers(rows[:1])[1][0])
    uv[dome] = dome_texture(np.interp(from_rim, np.arange(len(meridian)), meridian), theta[dome], rim)
    return uv
