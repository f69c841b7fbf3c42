# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A closed triangle surface of a lumen, cut from a scalar field on a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from arcgym.anatomy.measures import face_normals, winds_outwards


@dataclass(frozen=True)
class TriangleSurface:
    """A closed, connected triangle surface."""

    points: np.ndarray
    """Vertices [m], shape (n, 3)."""
    faces: np.ndarray
    """Triangles, normals out of the lumen, shape (F, 3), int."""

    def normals(self) -> np.ndarray:
        """Return unit normals of the vertices, out of the lumen, shape (n, 3)."""
        area = face_normals(self.points, self.faces)
        corner, weight = self.faces.T.ravel(), np.tile(area, (3, 1))
        sums = np.stack([np.bincount(corner, weight[:, k], len(self.points)) for k in range(3)], 1)
        return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)


def cut_surface(values: np.ndarray, origin: np.ndarray, spacing: float, level: float = 0.0) -> TriangleSurface:
    """Return the largest connected surface on which a field has a level (marching cubes, Lewiner et al., 2003).

    Args:
        values: Field, above ``level`` in the lumen, shape (X, Y, Z).
        origin: Center of the first voxel [m], shape (3,).
        spacing: Edge of a voxel [m].
        level: Value of the field at the lumen's wall.

    Raises:
        ValueError: The lumen is empty, fills the grid, or reaches the grid's border.
    """
    from skimage.measure import marching_cubes

    border = [values.take(side, axis).max() for axis in range(3) for side in (0, -1)]
    if max(border) > level or values.max() <= level:
        raise ValueError(
            f"The lumen must lie inside the grid: its largest value is {values.max():.3g}, on the border"
            f" {max(border):.3g}, and the wall is at {level:.3g}. Leave a margin of one voxel round it."
        )
    points, faces, _, _ = marching_cubes(np.ascontiguousarray(values, np.float32), level, allow_degenerate=False)
    return largest_part(np.asarray(origin) + spacing * points.astype(float), faces.astype(np.int64))


def largest_part(points: np.ndarray, faces: np.ndarray) -> TriangleSurface:
    """Return the connected part of a surface that has most triangles, wound outwards."""
    part = connected_parts(faces, len(points))
    faces = faces[part[faces[:, 0]] == np.bincount(part[faces[:, 0]]).argmax()]
    used = np.zeros(len(points), bool)
    used[faces] = True
    points, faces = points[used], (np.cumsum(used) - 1)[faces]
    return TriangleSurface(points, faces if winds_outwards(points, faces) else faces[:, ::-1].copy())


def connected_parts(simplices: np.ndarray, count: int) -> np.ndarray:
    """Return the number of the connected part of each vertex, shape (count,), of edges or triangles, shape (n, k)."""
    pairs = np.concatenate([simplices[:, [k, k + 1]] for k in range(simplices.shape[1] - 1)])
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def edge_keys(faces: np.ndarray, count: int) -> np.ndarray:
    """Return a number for the edge from each corner of triangles to the next one, the same from both sides.

    Args:
        faces: Triangles, shape (F, 3), int.
        count: Number of vertices, below 3e9.

    Returns:
        Numbers, ascending with the edge's lower vertex and then with its other one, shape (F, 3), int64.
    """
    following = np.roll(faces, -1, 1)
    return np.minimum(faces, following).astype(np.int64) * count + np.maximum(faces, following)


def edge_ends(keys: np.ndarray, count: int) -> np.ndarray:
    """Return the two vertices of edges numbered by :func:`edge_keys`, the lower one first, shape (n, 2)."""
    return np.stack([keys // count, keys % count], 1)
