# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Geometric measures of wall and surface meshes, used by the generator, the reader and the validation."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.stage.types import VisualMesh


def tet_volumes(points: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """Return the signed volume of each tetrahedron [m^3], shape (T,)."""
    a, b, c, d = (points[tets[:, k]].astype(np.float64) for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0


def tet_quality(points: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """Return the mean-ratio quality of each tetrahedron, shape (T,): 1 regular, 0 flat, negative inverted.

    ``12 (3 V)^(2/3) / sum of squared edges`` (Liu and Joe, BIT 34, 1994).
    """
    corners = points[tets].astype(np.float64)
    edges = corners[:, [0, 0, 0, 1, 1, 2]] - corners[:, [1, 2, 3, 2, 3, 3]]
    volume = tet_volumes(points, tets)
    return 12.0 * np.cbrt(3.0 * volume) ** 2 * np.sign(volume) / np.einsum("tij,tij->t", edges, edges)


def face_normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return unnormalized face normals (length twice the area) [m^2], shape (F, 3)."""
    a, b, c = (points[faces[:, k]].astype(np.float64) for k in range(3))
    return np.cross(b - a, c - a)


def inner_faces(tets: np.ndarray, layer: np.ndarray) -> np.ndarray:
    """Return the lumen side of the wall.

    Args:
        tets: Vertex indices, shape (T, 4).
        layer: Layer of each vertex, shape (V,).

    Returns:
        Boundary faces whose vertices all lie in layer 0, wound so that normals point from the lumen into the wall,
        shape (F, 3), int32.
    """
    # In a tetrahedron of positive volume these windings point towards the fourth vertex, that is into the wall.
    faces = np.concatenate([tets[:, [0, 1, 2]], tets[:, [0, 3, 1]], tets[:, [0, 2, 3]], tets[:, [1, 3, 2]]])
    faces = faces[(np.asarray(layer)[faces] == 0).all(1)]
    _, first, uses = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[uses == 1])].astype(np.int32)


def winds_outwards(points: np.ndarray, faces: np.ndarray) -> bool:
    """Return whether the faces of a tube enclose positive volume, that is, whether their normals leave the lumen."""
    center = points[faces].astype(np.float64).mean(1) - points.mean(0)
    return bool(np.einsum("ij,ij->", center, face_normals(points, faces)) > 0)


def flipped_normal_fraction(visual: VisualMesh) -> float:
    """Return the share of faces whose vertex normals point to the other side than their winding."""
    winding = face_normals(visual.points, visual.faces)
    normals = visual.normals[visual.faces].mean(1)
    return float((np.einsum("ij,ij->i", winding, normals) < 0).mean())
