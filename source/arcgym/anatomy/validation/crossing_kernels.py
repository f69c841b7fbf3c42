# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernel of the search for edges that pass through triangles."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def near_faces(
    mesh: wp.uint64,
    points: wp.array[wp.vec3],
    faces: wp.array2d[int],
    edges: wp.array2d[int],
    margin: float,
    count: wp.array[int],
    pairs: wp.array2d[int],
):
    """Pairs of an edge and a face whose boxes meet within a margin [m] and that share no vertex. Launch (E,).

    Those that fit are written to ``pairs``, shape (n, 2); ``count`` is how many there are.
    """
    i = wp.tid()
    a, b = edges[i, 0], edges[i, 1]
    around = wp.vec3(margin, margin, margin)
    query = wp.mesh_query_aabb(mesh, wp.min(points[a], points[b]) - around, wp.max(points[a], points[b]) + around)
    face = int(0)
    while wp.mesh_query_aabb_next(query, face):
        shared = int(0)
        for k in range(3):
            if faces[face, k] == a or faces[face, k] == b:
                shared += 1
        if shared == 0:
            n = wp.atomic_add(count, 0, 1)
            if n < pairs.shape[0]:
                pairs[n, 0] = i
                pairs[n, 1] = face
