# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface: a parameter grid with lesions, texture coordinates, normals and analytic skin weights."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from arcgym.anatomy.generator.lesions import Lesion, distance_to, shape_lesion
from arcgym.anatomy.generator.refine import refine
from arcgym.anatomy.generator.rows import row_positions
from arcgym.anatomy.generator.surface import DOME_LENGTH, Surface
from arcgym.anatomy.generator.vessel_styles import texture_rows
from arcgym.anatomy.measures import face_normals
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import TEXTURE_LENGTH, VisualMesh, WallMesh

_TWIST = 0.55
_DOME_ROW = 0.875


def sample_visual(
    surface: Surface, wall: WallMesh, lesions: list[Lesion], rows: int, columns: int, refinements: int
) -> VisualMesh:
    """Samples a surface finely and skins it to the wall's inner layer.

    Args:
        surface: The colon.
        wall: Its wall, sampled from the same surface.
        lesions: Diverticula and polyps to shape.
        rows: Cross sections, closer together where there are folds.
        columns: Points around the lumen.
        refinements: How often triangles on lesions are split into four; from the third time on at their rims only.
    """
    s, theta, faces, dome = _parameter_grid(surface, rows, columns)
    grid = np.stack([s, theta, dome], 1)
    for level in range(refinements):
        near = np.zeros(len(grid), bool)
        for lesion in lesions:
            share = distance_to(surface, lesion, grid[:, 0], grid[:, 1]) / lesion.patch
            near |= (share < 1.15) if level < 2 else (share > 0.5) & (share < 0.9)
        grid, faces = refine(grid, faces, near[faces].any(1))
    s, theta, dome = grid.T
    width = 0.0 if refinements > 1 else 0.8 * surface.curve.length / rows
    points, tint = _shaped_points(surface, lesions, s, theta, width)
    points = points.astype(np.float32)
    faces = faces[np.linalg.norm(face_normals(points, faces), axis=1) > 1e-12]
    skin_indices, skin_weights = skin_to_rings(s, theta, wall.ring_arc, wall.num_sectors)
    return VisualMesh(
        points=points,
        faces=faces.astype(np.int32),
        normals=smooth_normals(points, faces),
        uv=_texture_coordinates(surface, s, theta, dome > 0.5).astype(np.float32),
        tint=tint.astype(np.float32),
        skin_indices=skin_indices,
        skin_weights=skin_weights,
    )


def grid_triangles(rows: int, columns: int) -> np.ndarray:
    """Returns the triangles of an open grid (rows along, columns around), facing the lumen, shape (F, 3), int32."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a, b = i * columns + j, (i + 1) * columns + j
    c, d = b + 1, a + 1
    even = ((i + j) % 2 == 0)[..., None]
    first = np.where(even, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)]).astype(np.int32)


def smooth_normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Returns area-weighted vertex normals, continuous over the texture seam, shape (M, 3), float32.

    Vertices at the same place (to 1 um) share one normal.
    """
    _, place = np.unique(np.round(points * 1e6).astype(np.int64), axis=0, return_inverse=True)
    place = place.ravel()
    area = face_normals(points, faces)
    corner, weight = place[faces.T.ravel()], np.tile(area, (3, 1))
    sums = np.stack([np.bincount(corner, weight[:, k], place.max() + 1) for k in range(3)], 1)
    normals = sums[place]
    return (normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)).astype(np.float32)


def skin_to_rings(
    s: np.ndarray, theta: np.ndarray, ring_arc: np.ndarray, sectors: int
) -> tuple[np.ndarray, np.ndarray]:
    """Returns bilinear weights of surface points on the wall's inner grid.

    Args:
        s: Arc length of each point [m], shape (M,).
        theta: Angle around the lumen [rad], shape (M,); sector j of the wall stands at ``2 pi j / sectors``.
        ring_arc: Arc length of the wall's rings [m], shape (R,).
        sectors: Wall vertices around a ring.

    Returns:
        Wall vertex indices, shape (M, 4), int32, and weights that sum to 1, shape (M, 4), float32.
    """
    rows = np.interp(s, ring_arc, np.arange(len(ring_arc)))
    row = np.minimum(np.floor(rows).astype(int), len(ring_arc) - 2)
    along = rows - row
    columns = np.mod(theta, 2 * np.pi) * sectors / (2 * np.pi)
    column = np.floor(columns).astype(int)
    around = columns - column
    column, after = column % sectors, (column + 1) % sectors
    corners = [row * sectors + column, (row + 1) * sectors + column, (row + 1) * sectors + after, row * sectors + after]
    weights = [(1 - along) * (1 - around), along * (1 - around), along * around, (1 - along) * around]
    return np.stack(corners, 1).astype(np.int32), np.stack(weights, 1).astype(np.float32)


def _parameter_grid(surface: Surface, rows: int, columns: int) -> tuple[np.ndarray, ...]:
    """Returns arc length, angle, triangles and a dome mark; the dome of the caecum has vertices of its own.

    The seam of the texture at angle 0 and the edge of the dome have their vertices twice, once for each chart.
    """
    edge, theta = surface.curve.length - DOME_LENGTH, np.linspace(0, 2 * np.pi, columns + 1)
    dome_rows = max(6, rows // 40)
    polar = np.linspace(0.0, 0.5 * np.pi, dome_rows)
    tube = row_positions(surface, theta, 0.0, edge, rows - dome_rows)
    cap = np.repeat((edge + DOME_LENGTH * np.sin(polar))[:, None], columns + 1, 1)
    cap[-1] = surface.curve.length
    parts, faces, offset = [], [], 0
    for s, mark in ((tube, 0.0), (cap, 1.0)):
        parts.append(np.stack([s, np.broadcast_to(theta, s.shape), np.full_like(s, mark)], -1).reshape(-1, 3))
        faces.append(grid_triangles(len(s), columns + 1) + offset)
        offset += s.size
    s, angle, dome = np.concatenate(parts).T
    return s, angle, np.concatenate(faces), dome


def _shaped_points(
    surface: Surface, lesions: list[Lesion], s: np.ndarray, theta: np.ndarray, min_width: float
) -> tuple[np.ndarray, np.ndarray]:
    """Returns positions [m] and tint of all vertices."""
    around = np.where(theta > 2 * np.pi - 1e-9, 0.0, theta)
    points = surface.points(s, around, 1.0, min_width)
    tint = np.zeros(len(s))
    for lesion in lesions:
        near = np.flatnonzero(distance_to(surface, lesion, s, theta) < lesion.patch)
        if len(near):
            points[near], tint[near] = shape_lesion(surface, lesion, s[near], theta[near], points[near])
    return points, tint


def _texture_coordinates(surface: Surface, s: np.ndarray, theta: np.ndarray, dome: np.ndarray) -> np.ndarray:
    """Returns u round the lumen and v along it, shape (M, 2)."""
    bounds = {name: surface.curve.bounds(name) for name in SEGMENTS}
    uv = tube_texture(s, theta, bounds)
    edge = surface.curve.length - DOME_LENGTH
    rim = float(surface.lumen_radius(np.array(edge)))
    close = np.clip((surface.curve.length - s[dome]) / DOME_LENGTH, 0.0, 1.0)
    uv[dome] = dome_texture(np.arccos(1.0 - close) * 0.5 * (rim + DOME_LENGTH), theta[dome], rim)
    return uv


def tube_texture(s: np.ndarray, theta: np.ndarray, bounds: Mapping[str, tuple[float, float]]) -> np.ndarray:
    """Returns u round the lumen and v along it, in the band that shows the segment's vessels, shape (n, 2).

    u turns slowly with the arc length, so that no two passes over a band of the texture look the same.

    Args:
        s: Arc lengths [m], shape (n,).
        theta: Angles round the lumen [rad], shape (n,).
        bounds: Arc length where each segment starts and ends [m].
    """
    return np.stack([theta / (2 * np.pi) + s / _TWIST, texture_rows(s, bounds, TEXTURE_LENGTH)], 1)


def dome_texture(meridian: np.ndarray, theta: np.ndarray, rim: float) -> np.ndarray:
    """Returns u and v on the dome of the caecum, equal distances from the pole in every direction, shape (n, 2).

    A polar chart would squeeze the texture into streaks at the pole.

    Args:
        meridian: Distance from the pole along the wall [m], shape (n,).
        theta: Angles round the lumen [rad], shape (n,).
        rim: Radius of the lumen where the dome begins [m].
    """
    u = 0.5 + meridian * np.cos(theta) / (2 * np.pi * rim)
    return np.stack([u, _DOME_ROW + meridian * np.sin(theta) / TEXTURE_LENGTH], 1)
