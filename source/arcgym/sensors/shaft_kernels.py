# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels that put the scope's own shaft into a picture, where a tip that is bent back sees it."""

import warp as wp

from arcgym.sensors.shading_kernels import Hit, Lighting, lit_by
from arcgym.utils import warp_setup  # noqa: F401

SHAFT_COLOR = wp.constant(0.04)
"""Linear albedo of the shaft: black polymer."""
SHAFT_GLOSS = wp.constant(0.4)
"""Brightness of its highlights, as of :class:`arcgym.sensors.LightingCfg`."""
SHAFT_ROUGHNESS_SQ = wp.constant(0.04)
"""Square of the width of its highlights."""


@wp.func
def ray_capsule(origin: wp.vec3, direction: wp.vec3, a: wp.vec3, b: wp.vec3, radius: float) -> float:
    """Return the distance along a ray to a capsule from ``a`` to ``b``; negative where it is missed or behind."""
    axis = b - a
    start = origin - a
    axis_sq = wp.dot(axis, axis)
    along_ray = wp.dot(axis, direction)
    along_start = wp.dot(axis, start)
    quadratic = axis_sq - along_ray * along_ray
    linear = axis_sq * wp.dot(direction, start) - along_start * along_ray
    constant = axis_sq * wp.dot(start, start) - along_start * along_start - radius * radius * axis_sq
    root = linear * linear - quadratic * constant
    if root < 0.0:
        return -1.0
    end = start
    if quadratic > 1.0e-9 * axis_sq:
        distance = (-linear - wp.sqrt(root)) / quadratic
        place = along_start + distance * along_ray
        if place > 0.0 and place < axis_sq:
            return distance
        if place > 0.0:
            end = origin - b
    elif along_start > 0.0:
        end = origin - b
    half = wp.dot(direction, end)
    root = half * half - wp.dot(end, end) + radius * radius
    if root < 0.0:
        return -1.0
    return -half - wp.sqrt(root)


@wp.func
def capsule_normal(position: wp.vec3, a: wp.vec3, b: wp.vec3) -> wp.vec3:
    """Return the outward normal of a capsule at a point of its surface."""
    axis = b - a
    share = wp.clamp(wp.dot(position - a, axis) / wp.dot(axis, axis), 0.0, 1.0)
    return wp.normalize(position - a - axis * share)


@wp.kernel
def cast_shaft(
    link_pos: wp.array2d[wp.vec3],
    link_quat: wp.array2d[wp.quat],
    link_radius: wp.array[float],
    link_half: wp.array[float],
    lighting: Lighting,
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    depth: wp.array3d[float],
    radiance: wp.array3d[wp.vec3],
    distance: wp.array3d[float],
    normal: wp.array3d[wp.vec3],
):
    """Find the shaft in the middle of every pixel, and light it where it hides the wall. Launch (N, H, W).

    Args:
        link_pos: Middle of each link [m], shape (N, L); the last one carries the camera and is left out.
        link_quat: Orientation of each link, shape (N, L).
        link_radius: Radius of each link [m], shape (L,).
        link_half: Half the length of each link [m], shape (L,).
        lighting: Lights.
        poses: Camera poses, shape (N,).
        rays: Directions in the camera's frame, shape (H, W, 1).
        covered: Worlds whose lens is covered, shape (N,).
        depth: Distance to the wall along the ray [m], shape (N, H, W).
        radiance: Linear radiance, shape (N, H, W); replaced where the shaft is nearer.
        distance: Distance to the shaft along the ray [m], shape (N, H, W); written, negative where there is none.
        normal: Unit normal of the shaft there in the camera's frame, shape (N, H, W); written.
    """
    world, row, column = wp.tid()
    distance[world, row, column] = -1.0
    if covered[world]:
        return
    camera = poses[world]
    origin = wp.transform_get_translation(camera)
    direction = wp.transform_vector(camera, rays[row, column, 0])
    nearest = depth[world, row, column]
    first = wp.vec3(0.0)
    second = wp.vec3(0.0)
    found = int(-1)
    for link in range(link_radius.shape[0] - 1):
        middle = link_pos[world, link]
        reach = link_half[link] + link_radius[link]
        ahead = wp.dot(middle - origin, direction)
        beside = wp.length_sq(middle - origin) - ahead * ahead
        if ahead > -reach and beside < reach * reach:
            half = wp.quat_rotate(link_quat[world, link], wp.vec3(0.0, 0.0, link_half[link]))
            there = ray_capsule(origin, direction, middle - half, middle + half, link_radius[link])
            if there > 0.0 and there < nearest:
                nearest = there
                found = link
                first = middle - half
                second = middle + half
    if found < 0:
        return
    hit = Hit()
    hit.position = origin + direction * nearest
    hit.normal = capsule_normal(hit.position, first, second)
    axis = wp.transform_vector(camera, wp.vec3(0.0, 0.0, -1.0))
    color = wp.vec3(SHAFT_COLOR)
    total = wp.vec3(0.0)
    for side in range(2):
        lamp = lighting.left
        if side == 1:
            lamp = lighting.right
        total += lit_by(
            wp.transform_point(camera, lamp),
            hit,
            hit.normal,
            hit.normal,
            direction,
            axis,
            color,
            SHAFT_GLOSS,
            SHAFT_ROUGHNESS_SQ,
            lighting,
        )
    radiance[world, row, column] = total
    distance[world, row, column] = nearest
    normal[world, row, column] = wp.transform_vector(wp.transform_inverse(camera), hit.normal)


@wp.kernel
def mark_shaft(
    distance: wp.array3d[float],
    shaft_normal: wp.array3d[wp.vec3],
    kind: wp.uint8,
    depth: wp.array3d[float],
    normal: wp.array3d[wp.vec3],
    label: wp.array3d[wp.uint8],
):
    """Take over the shaft where it is nearer than the wall. Launch (N, H, W).

    Args:
        distance: Distance to the shaft along the ray [m], negative where there is none, shape (N, H, W).
        shaft_normal: Its normal, shape (N, H, W).
        kind: Its label.
        depth: Distance along the ray [m], shape (N, H, W); updated.
        normal: Normal, shape (N, H, W); updated.
        label: Kind of what is seen, shape (N, H, W); updated.
    """
    world, row, column = wp.tid()
    there = distance[world, row, column]
    if there > 0.0 and there < depth[world, row, column]:
        depth[world, row, column] = there
        normal[world, row, column] = shaft_normal[world, row, column]
        label[world, row, column] = kind
