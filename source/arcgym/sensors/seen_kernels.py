# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernel that marks what of the mucosa a picture shows. N worlds, H x W pixels, M vertices, P patients, K polyps."""

import warp as wp

from arcgym.sensors.shading_kernels import SurfaceView, nearest_hit
from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def mark_seen(
    surface: SurfaceView,
    area: wp.array2d[wp.int32],
    polyp: wp.array2d[wp.int32],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    reach: float,
    seen: wp.array2d[wp.int32],
    seen_area: wp.array[wp.int32],
    pixels: wp.array2d[wp.int32],
):
    """Trace one ray through the middle of every pixel and mark the vertex nearest to where it meets. Launch (N, H, W).

    All sums are of integers: the order of the rays does not matter.

    Args:
        surface: Surface of all worlds.
        area: Share of the mucosa that each vertex of each patient stands for, in parts of a billion, shape (M, P).
        polyp: Polyp of each vertex of each patient, -1 for none, shape (M, P).
        poses: Camera poses, shape (N,).
        rays: Directions in the camera's frame, shape (H, W, S).
        covered: Worlds whose lens is covered, shape (N,).
        reach: Distance beyond which nothing counts as seen [m].
        seen: 1 for vertices that were seen, shape (N, M); updated.
        seen_area: Sum of their areas, shape (N,); updated.
        pixels: Pixels that show each polyp, shape (N, K); added to.
    """
    world, row, column = wp.tid()
    if covered[world]:
        return
    camera = poses[world]
    direction = wp.transform_vector(camera, rays[row, column, 0])
    origin = wp.transform_get_translation(camera)
    hit = nearest_hit(surface, world, origin, direction, reach)
    if hit.face < 0:
        return
    weight = wp.vec3(hit.u, hit.v, 1.0 - hit.u - hit.v)
    nearest = wp.int32(0)
    for k in range(3):
        if weight[k] > weight[nearest]:
            nearest = k
    vertex = wp.mesh_get_index(surface.mesh, hit.face * 3 + nearest) - world * area.shape[0]
    patient = surface.patient[world]
    if wp.atomic_max(seen, world, vertex, 1) == 0:
        wp.atomic_add(seen_area, world, area[vertex, patient])
    if polyp[vertex, patient] >= 0:
        wp.atomic_add(pixels, world, polyp[vertex, patient], 1)
