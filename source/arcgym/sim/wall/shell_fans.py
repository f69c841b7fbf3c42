# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest geometry of a shell for its kernels, in numpy: cotangents, and the fan of triangles around each vertex."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.assets.shell_geometry import ShellGeometry, hinge_of_edges


def triangle_rest(geometry: ShellGeometry) -> np.ndarray:
    """Return each corner's cotangent over twice the area [1/m^2] and the area [m^2] of every triangle, shape (F, 4).

    The cotangents are minus the products of the other two corners' shape gradients.
    """
    m = np.concatenate([-geometry.inv_rest.sum(axis=1, keepdims=True), geometry.inv_rest], axis=1)
    products = np.einsum("tac,tbc->tab", m, m)
    return np.column_stack([-products[:, 1, 2], -products[:, 2, 0], -products[:, 0, 1], geometry.area])


def own_hinges(geometry: ShellGeometry) -> np.ndarray:
    """Hinge at the edge opposite to each corner of each triangle, -1 at a border, shape (F, 3)."""
    return hinge_of_edges(geometry.triangles, geometry.hinges, geometry.sides)


def ordered_corners(triangles: np.ndarray, start: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """Return the corners around each vertex so that a triangle follows the one across its spoke, where there is one.

    Args:
        triangles: Vertices of the triangles, shape (F, 3).
        start: First corner of each vertex, shape (V + 1,).
        corner: Corners, 3 * triangle + corner, shape (3*F,).
    """
    first, second = (triangles.ravel()[corner // 3 * 3 + (corner % 3 + k) % 3].tolist() for k in (1, 2))
    out = corner.tolist()
    for begin, end in zip(start[:-1].tolist(), start[1:].tolist(), strict=True):
        left = {first[k]: k for k in range(begin, end)}
        seconds = {second[k] for k in range(begin, end)}
        at = begin
        while left:
            k: int | None = next((left[v] for v in left if v not in seconds), next(iter(left.values())))
            while k is not None:
                del left[first[k]]
                seconds.discard(second[k])
                out[at] = int(corner[k])
                at += 1
                k = left.get(second[k])
        if at < end:
            raise ValueError(f"Two triangles around vertex {triangles.ravel()[corner[begin]]} lie on one another.")
    return np.array(out, dtype=corner.dtype)


def vertex_triangles(geometry: ShellGeometry, corner: np.ndarray, dtypes: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return each corner's view of its triangle and of two of the hinges there.

    Args:
        geometry: Rest geometry.
        corner: Corners, 3 * triangle + corner, shape (n,).
        dtypes: Of :class:`arcgym.sim.wall.shell_kernels.VertexTriangle` and ``VertexTriangleRest``, whose fields are
            filled.

    Returns:
        What is connected with what, the same for all patients, and the rest shape, shape (n,) each.
    """
    fan, shape = (np.zeros(len(corner), dtype) for dtype in dtypes)
    owner, turned = corner // 3, (corner[:, None] + np.arange(3)) % 3  # corners of the triangle, this one first
    vertex, rest, edges = geometry.triangles[owner[:, None], turned], triangle_rest(geometry), own_hinges(geometry)
    fan["first"], fan["second"], fan["index"] = vertex[:, 1], vertex[:, 2], owner
    shape["rest"] = np.column_stack([rest[owner[:, None], turned], rest[owner, 3]])
    for name, edge, start in (("rim", 0, 1), ("spoke", 2, 0)):
        hinge = edges[owner, turned[:, edge]]
        beyond = (geometry.sides[hinge, 0] == owner).astype(int)  # which of the hinge's sides is not this triangle
        fan[name] = np.maximum(hinge, 0)
        fan[f"{name}_vertex"] = geometry.hinges[hinge, beyond]
        fan[f"{name}_triangle"] = geometry.sides[hinge, beyond]
        foot = geometry.foot[hinge[:, None], np.stack([1 - beyond, beyond], axis=1)]
        backwards = geometry.hinges[hinge, 2] != vertex[:, start]
        foot[backwards] = 1.0 - foot[backwards]
        stiffness = np.where(hinge >= 0, geometry.bound[hinge], 0.0)
        shape[name] = np.column_stack([geometry.length[hinge], foot, stiffness])
    return fan, shape
