# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface of a generated colon: a parameter grid along the folds, refined and shaped at lesions."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.generator.lesion_shapes import distance_to, shape_lesion
from arcgym.anatomy.generator.lesions import Lesion
from arcgym.anatomy.generator.rows import row_positions
from arcgym.anatomy.generator.surface import DOME_LENGTH, Surface
from arcgym.anatomy.measures import face_normals
from arcgym.anatomy.meshing.refine import refine
from arcgym.anatomy.meshing.surface_grid import (
    dome_texture,
    grid_triangles,
    skin_to_rings,
    smooth_normals,
    tube_texture,
)
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import VisualMesh, WallMesh


def sample_visual(
    surface: Surface, wall: WallMesh, lesions: list[Lesion], rows: int, columns: int, refinements: int
) -> VisualMesh:
    """Sample a surface finely and skin it to the wall's inner layer.

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


def _parameter_grid(surface: Surface, rows: int, columns: int) -> tuple[np.ndarray, ...]:
    """Return arc length, angle, triangles and a dome mark; the dome of the caecum has vertices of its own.

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
    """Return positions [m] and tint of all vertices."""
    around = np.where(theta > 2 * np.pi - 1e-9, 0.0, theta)
    points = surface.points(s, around, 1.0, min_width)
    tint = np.zeros(len(s))
    for lesion in lesions:
        near = np.flatnonzero(distance_to(surface, lesion, s, theta) < lesion.patch)
        if len(near):
            points[near], tint[near] = shape_lesion(surface, lesion, s[near], theta[near], points[near])
    return points, tint


def _texture_coordinates(surface: Surface, s: np.ndarray, theta: np.ndarray, dome: np.ndarray) -> np.ndarray:
    """Return u round the lumen and v along it, shape (M, 2)."""
    bounds = {name: surface.curve.bounds(name) for name in SEGMENTS}
    uv = tube_texture(s, theta, bounds)
    edge = surface.curve.length - DOME_LENGTH
    rim = float(surface.lumen_radius(np.array(edge)))
    close = np.clip((surface.curve.length - s[dome]) / DOME_LENGTH, 0.0, 1.0)
    uv[dome] = dome_texture(np.arccos(1.0 - close) * 0.5 * (rim + DOME_LENGTH), theta[dome], rim)
    return uv
