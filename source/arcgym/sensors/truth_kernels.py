# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernel of what a picture shows, for learning from pictures: distance, normal and kind of surface of every pixel."""

import warp as wp

from arcgym.sensors.shading_kernels import SurfaceView, nearest_hit
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def look_closer(
    surface: SurfaceView,
    labels: wp.array2d[wp.uint8],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    near: float,
    far: float,
    depth: wp.array3d[float],
    normal: wp.array3d[wp.vec3],
    label: wp.array3d[wp.uint8],
):
    """Trace one ray through the middle of every pixel. Launch (N, H, W).

    Args:
        surface: Surface of all worlds.
        labels: Kind of each vertex of each patient, shape (M, P).
        poses: Camera poses, shape (N,).
        rays: Directions in the camera's frame, shape (H, W, 1).
        covered: Worlds whose lens is covered, shape (N,).
        near: Distance given where the lens is covered [m].
        far: Distance given where nothing is hit [m].
        depth: Distance along the ray [m], shape (N, H, W); written.
        normal: Unit normal towards the camera in its frame, zero where nothing is hit, shape (N, H, W); written.
        label: Kind of the vertex with the largest share, 0 where nothing is hit, shape (N, H, W); written.
    """
    world, row, column = wp.tid()
    depth[world, row, column] = far
    normal[world, row, column] = wp.vec3(0.0)
    label[world, row, column] = wp.uint8(0)
    if covered[world]:
        depth[world, row, column] = near
        return
    camera = poses[world]
    direction = wp.transform_vector(camera, rays[row, column, 0])
    origin = wp.transform_get_translation(camera)
    hit = nearest_hit(surface, world, origin, direction, far)
    if hit.face < 0:
        return
    corner = hit.face * 3
    weight = wp.vec3(hit.u, hit.v, 1.0 - hit.u - hit.v)
    first = world * labels.shape[0]
    total = wp.vec3(0.0)
    nearest = int(0)
    for k in range(3):
        vertex = wp.mesh_get_index(surface.mesh, corner + k)
        total += surface.normals[vertex] * weight[k]
        if weight[k] > weight[nearest]:
            nearest = k
    if wp.dot(total, direction) > 0.0:
        total = -total
    depth[world, row, column] = hit.t
    normal[world, row, column] = wp.transform_vector(wp.transform_inverse(camera), wp.normalize(total))
    kind = wp.mesh_get_index(surface.mesh, corner + nearest) - first
    label[world, row, column] = labels[kind, surface.patient[world]]
