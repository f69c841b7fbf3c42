# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Topology and intersections of triangle meshes: whether a wall is closed, crosses itself, and what it encloses."""

from __future__ import annotations

import numpy as np

_BLOCK = 200_000
"""Pairs of edge and face that are tested at once, which bounds the memory."""

_MARGIN = 1e-5
"""Distance at which boxes still count as meeting [m]: more than positions in single precision are off."""


def boundary_faces(tets: np.ndarray) -> np.ndarray:
    """Return the faces that belong to one tetrahedron only, normals outwards, shape (F, 3), int32."""
    faces = np.concatenate([tets[:, [0, 2, 1]], tets[:, [0, 1, 3]], tets[:, [0, 3, 2]], tets[:, [1, 2, 3]]])
    _, first, uses = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[uses == 1])].astype(np.int32)


def edge_uses(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return each edge once, shape (E, 2), and by how many faces it is used, shape (E,)."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    return np.unique(edges, axis=0, return_counts=True)


def count_crossings(points: np.ndarray, faces: np.ndarray) -> int:
    """Count the pairs of an edge and a face that cross without sharing a vertex; 0 for a mesh free of them.

    Args:
        points: Vertices [m], shape (V, 3).
        faces: Triangles, shape (F, 3).
    """
    return len(find_crossings(points, faces))


def find_crossings(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the vertices, two of an edge and three of a face, of each pair that crosses, shape (n, 5)."""
    points = points.astype(np.float64)
    edges, _ = edge_uses(faces)
    edge, face = _near_pairs(points, edges, faces)
    blocks = range(0, len(edge), _BLOCK)
    hit = [_crosses(points, edges[edge[k : k + _BLOCK]], faces[face[k : k + _BLOCK]]) for k in blocks]
    crossing = np.concatenate(hit) if hit else np.zeros(0, bool)
    return np.concatenate([edges[edge[crossing]], faces[face[crossing]]], axis=1)


def _near_pairs(points: np.ndarray, edges: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return edges and faces whose boxes meet and that share no vertex, in order."""
    from arcgym.utils import warp_setup  # noqa: F401  isort: skip
    import warp as wp

    from arcgym.anatomy.validation.crossing_kernels import near_faces

    vertices = wp.array(points, dtype=wp.vec3, device="cpu")
    corners = np.ascontiguousarray(faces, np.int32)
    mesh = wp.Mesh(vertices, wp.array(corners.ravel(), dtype=int, device="cpu"))
    given = [vertices, wp.array(corners, dtype=int, device="cpu"), wp.array(edges.astype(np.int32), device="cpu")]
    room = len(edges)
    while True:
        count, pairs = wp.zeros(1, dtype=int, device="cpu"), wp.empty((room, 2), dtype=int, device="cpu")
        wp.launch(near_faces, len(edges), inputs=[mesh.id, *given, _MARGIN], outputs=[count, pairs], device="cpu")
        found = int(count.numpy()[0])
        if found <= room:
            edge, face = pairs.numpy()[:found].astype(int).T
            order = np.lexsort((face, edge))
            return edge[order], face[order]
        room = found


def _crosses(points: np.ndarray, edges: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return whether, of each pair, the edge passes through the triangle (Moeller and Trumbore, 1997), shape (n,)."""
    start, direction = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    corner = points[faces[:, 0]]
    first, second = points[faces[:, 1]] - corner, points[faces[:, 2]] - corner
    across = np.cross(direction, second)
    determinant = np.einsum("ij,ij->i", first, across)
    parallel = np.abs(determinant) < 1e-18
    inverse = 1.0 / np.where(parallel, 1.0, determinant)
    offset = start - corner
    turned = np.cross(offset, first)
    u = np.einsum("ij,ij->i", offset, across) * inverse
    v = np.einsum("ij,ij->i", direction, turned) * inverse
    t = np.einsum("ij,ij->i", second, turned) * inverse
    return ~parallel & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)


def winding_numbers(points: np.ndarray, faces: np.ndarray, queries: np.ndarray) -> np.ndarray:
    """Return how often a closed surface winds round each query point: 1 inside, 0 outside.

    Sums signed solid angles (Van Oosterom and Strackee, IEEE TBME 1983).

    Args:
        points: Vertices [m], shape (V, 3).
        faces: Triangles with outward normals, shape (F, 3).
        queries: Points [m], shape (Q, 3).
    """
    corners = points.astype(np.float64)[faces]
    numbers = np.empty(len(queries))
    for k, query in enumerate(queries.astype(np.float64)):
        a, b, c = (corners[:, i] - query for i in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = (np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a)))
        base = la * lb * lc + sum(dot * length for dot, length in zip(dots, (lc, la, lb), strict=True))
        numbers[k] = np.arctan2(volume, base).sum() / (2 * np.pi)
    return numbers


def cap_openings(faces: np.ndarray) -> np.ndarray:
    """Return the faces with every opening closed by a fan, so that the surface encloses a volume, shape (F', 3)."""
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    known = {(int(a), int(b)) for a, b in directed}
    following = {b: a for a, b in known if (b, a) not in known}
    caps = []
    while following:
        hub, at = following.popitem()
        while at in following:
            after = following.pop(at)
            if after != hub:
                caps.append((hub, at, after))
            at = after
    return np.concatenate([faces, np.array(caps, np.int32).reshape(-1, 3)])
