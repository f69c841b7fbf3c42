# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""The kernels of :mod:`arcgym.sensors.skinning_kernels` for a GPU, whose memory they use better.

Neighboring threads are of neighboring worlds, so the numbers of a frame lie by world; and of the surface, whose
vertices lie world by world for the rays, a thread writes several at once. Results differ by rounding.

Launch dimensions: V wall vertices, M vertices of the visual surface, W worlds; P patients.
"""

import warp as wp

from arcgym.sensors.skinning_kernels import wall_frame
from arcgym.utils import warp_setup  # noqa: F401

VERTICES = 4
"""Vertices that a thread skins, one after the other in memory: as many numbers as three vectors of four have."""
Vertices = wp.types.matrix(shape=(VERTICES, 3), dtype=float)


@wp.func_native("""
    float* const to = reinterpret_cast<float*>(vectors.data + first);
#if defined(__CUDA_ARCH__)
    if (count == 4 && (reinterpret_cast<unsigned long long>(to) & 15) == 0) {
        for (int k = 0; k < 3; ++k) {
            const float* const v = &values.data[0][0] + 4 * k;
            reinterpret_cast<float4*>(to)[k] = make_float4(v[0], v[1], v[2], v[3]);
        }
        return;
    }
#endif
    for (int j = 0; j < count; ++j)
        for (int k = 0; k < 3; ++k) to[3 * j + k] = values.data[j][k];
""")
def put_vertices(vectors: wp.array[wp.vec3], first: int, count: int, values: Vertices):
    """Write the first ``count`` of ``VERTICES`` vectors, from ``vectors[first]`` on."""
    ...


@wp.kernel
def wall_frame_numbers(
    nodes: wp.array2d[wp.vec3],
    neighbors: wp.array[wp.vec4i],
    drawn: wp.array[wp.bool],
    frames: wp.array3d[float],
):
    """Compute an orthonormal frame of every wall vertex. Launch (V, W).

    Args:
        nodes: Wall positions [m], shape (V, W).
        neighbors: Vertices ahead, behind, and on either side around the colon, shape (V,).
        drawn: Worlds to update, shape (W,).
        frames: Columns along the colon, around it and across the wall, row by row, shape (V, 9, W); written.
    """
    node, world = wp.tid()
    if not drawn[world]:
        return
    frame = wall_frame(nodes, neighbors[node], world)
    for i in range(3):
        for j in range(3):
            frames[node, 3 * i + j, world] = frame[i, j]


@wp.kernel
def skin_parts(
    nodes: wp.array2d[wp.vec3],
    frames: wp.array3d[float],
    patient: wp.array[int],
    skin_indices: wp.array2d[wp.vec4i],
    skin_weights: wp.array2d[wp.vec4],
    rest_offsets: wp.array3d[wp.vec3],
    rest_normals: wp.array3d[wp.vec3],
    drawn: wp.array[wp.bool],
    points: wp.array[wp.vec3],
    normals: wp.array[wp.vec3],
):
    """Skin by linear blending: p = sum_k w_k (x_k + F_k o_k), and the normals alike. Launch (ceil(M / VERTICES), W).

    Args:
        nodes: Wall positions x [m], shape (V, W).
        frames: Frames F of the wall vertices, shape (V, 9, W).
        patient: Patient of each world, shape (W,).
        skin_indices: Wall vertices that carry each vertex, shape (M, P).
        skin_weights: Weights w, shape (M, P).
        rest_offsets: Offsets o in the frames [m], shape (M, 4, P).
        rest_normals: Normals in the frames, shape (M, 4, P).
        drawn: Worlds to update, shape (W,).
        points: Positions [m], shape (W*M,); written.
        normals: Unit normals, shape (W*M,); written.
    """
    part, world = wp.tid()
    if not drawn[world]:
        return
    p = patient[world]
    first = part * VERTICES
    count = wp.min(VERTICES, skin_indices.shape[0] - first)
    placed = Vertices()
    turned = Vertices()
    for j in range(VERTICES):
        if j < count:
            vertex = first + j
            index = skin_indices[vertex, p]
            weight = skin_weights[vertex, p]
            point = wp.vec3(0.0)
            normal = wp.vec3(0.0)
            for k in range(4):
                if weight[k] != 0.0:
                    node = index[k]
                    frame = wp.mat33(
                        frames[node, 0, world],
                        frames[node, 1, world],
                        frames[node, 2, world],
                        frames[node, 3, world],
                        frames[node, 4, world],
                        frames[node, 5, world],
                        frames[node, 6, world],
                        frames[node, 7, world],
                        frames[node, 8, world],
                    )
                    point += weight[k] * (nodes[node, world] + frame * rest_offsets[vertex, k, p])
                    normal += weight[k] * (frame * rest_normals[vertex, k, p])
            placed[j] = point
            turned[j] = wp.normalize(normal)
    put_vertices(points, world * skin_indices.shape[0] + first, count, placed)
    put_vertices(normals, world * skin_indices.shape[0] + first, count, turned)
