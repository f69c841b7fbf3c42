# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels that carry the visual surface along with the deforming wall, all worlds in one launch.

Launch dimensions: V wall vertices, M vertices of the visual surface, W worlds; P patients.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def wall_frame(nodes: wp.array2d[wp.vec3], near: wp.vec4i, world: int) -> wp.mat33:
    """Return the orthonormal frame of a wall vertex from the vertices ahead, behind, and on either side of it."""
    along = wp.normalize(nodes[near[0], world] - nodes[near[1], world])
    around = nodes[near[2], world] - nodes[near[3], world]
    across = wp.normalize(wp.cross(along, around))
    frame = wp.identity(n=3, dtype=float)
    if wp.length_sq(across) > 0.5:
        frame = wp.matrix_from_cols(along, wp.cross(across, along), across)
    return frame


@wp.kernel
def wall_frames(
    nodes: wp.array2d[wp.vec3],
    neighbors: wp.array[wp.vec4i],
    drawn: wp.array[wp.bool],
    frames: wp.array2d[wp.mat33],
):
    """Compute an orthonormal frame of every wall vertex. Launch (V, W).

    Args:
        nodes: Wall positions [m], shape (V, W).
        neighbors: Vertices ahead, behind, and on either side around the colon, shape (V,).
        drawn: Worlds to update, shape (W,).
        frames: Columns along the colon, around it and across the wall, shape (V, W); written.
    """
    node, world = wp.tid()
    if not drawn[world]:
        return
    frames[node, world] = wall_frame(nodes, neighbors[node], world)


@wp.kernel
def skin_vertices(
    nodes: wp.array2d[wp.vec3],
    frames: wp.array2d[wp.mat33],
    patient: wp.array[int],
    skin_indices: wp.array2d[wp.vec4i],
    skin_weights: wp.array2d[wp.vec4],
    rest_offsets: wp.array3d[wp.vec3],
    rest_normals: wp.array3d[wp.vec3],
    drawn: wp.array[wp.bool],
    points: wp.array[wp.vec3],
    normals: wp.array[wp.vec3],
):
    """Skin by linear blending: p = sum_k w_k (x_k + F_k o_k), and the normals alike. Launch (M, W).

    Args:
        nodes: Wall positions x [m], shape (V, W).
        frames: Frames F of the wall vertices, shape (V, W).
        patient: Patient of each world, shape (W,).
        skin_indices: Wall vertices that carry each vertex, shape (M, P).
        skin_weights: Weights w, shape (M, P).
        rest_offsets: Offsets o in the frames [m], shape (M, 4, P).
        rest_normals: Normals in the frames, shape (M, 4, P).
        drawn: Worlds to update, shape (W,).
        points: Positions [m], shape (W*M,); written.
        normals: Unit normals, shape (W*M,); written.
    """
    vertex, world = wp.tid()
    if not drawn[world]:
        return
    p = patient[world]
    index = skin_indices[vertex, p]
    weight = skin_weights[vertex, p]
    point = wp.vec3(0.0)
    normal = wp.vec3(0.0)
    for k in range(4):
        frame = frames[index[k], world]
        point += weight[k] * (nodes[index[k], world] + frame * rest_offsets[vertex, k, p])
        normal += weight[k] * (frame * rest_normals[vertex, k, p])
    points[world * skin_indices.shape[0] + vertex] = point
    normals[world * skin_indices.shape[0] + vertex] = wp.normalize(normal)
