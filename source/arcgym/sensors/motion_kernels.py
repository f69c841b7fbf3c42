# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of a camera that moves while its shutter is open, and whose pictures are late. N worlds, V wall vertices."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

MOMENTS = wp.constant(8)
"""Moments of an exposure that are averaged."""


@wp.kernel
def look_from(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    links: int,
    offset: wp.transform,
    taken: wp.array[wp.bool],
    pose: wp.array[wp.transform],
    motion: wp.array[wp.spatial_vector],
):
    """Compute the camera's pose and its velocity and spin in its own frame. Launch (N,).

    Args:
        body_q: Link poses, shape (N*L,).
        body_qd: Link velocities [m/s, rad/s], shape (N*L,).
        links: Links a world, L.
        offset: Camera in the last link's frame.
        taken: Worlds to do this for, shape (N,).
        pose: Camera pose, shape (N,); written.
        motion: Its velocity [m/s] and spin [rad/s], shape (N,); written.
    """
    w = wp.tid()
    if not taken[w]:
        return
    link = (w + 1) * links - 1
    own = wp.transform_multiply(body_q[link], offset)
    spin = wp.spatial_bottom(body_qd[link])
    arm = wp.transform_get_translation(own) - wp.transform_get_translation(body_q[link])
    velocity = wp.spatial_top(body_qd[link]) + wp.cross(spin, arm)
    turn = wp.quat_inverse(wp.transform_get_rotation(own))
    pose[w] = own
    motion[w] = wp.spatial_vector(wp.quat_rotate(turn, velocity), wp.quat_rotate(turn, spin))


@wp.kernel
def keep_wall(nodal_pos: wp.array2d[wp.vec3], taken: wp.array[wp.bool], kept: wp.array2d[wp.vec3]):
    """Copy the wall of some worlds. Launch (V, N).

    Args:
        nodal_pos: Wall vertices [m], shape (V, N).
        taken: Worlds to copy, shape (N,).
        kept: Copies [m], shape (V, N); written.
    """
    v, w = wp.tid()
    if taken[w]:
        kept[v, w] = nodal_pos[v, w]


@wp.func
def exposure_time(gain: float, shutter: wp.vec3) -> float:
    """Return how long the shutter is open [s]: the longest time at the gain that needs it, less in brighter light."""
    return wp.clamp(shutter[1] * gain / shutter[2], shutter[0], shutter[1])


@wp.func
def pixel_of(place: wp.vec3, focal: float) -> wp.vec2:
    """Return where an equidistant fisheye shows a place in its frame [px], from the middle, to the right and down."""
    aside = wp.sqrt(place[0] * place[0] + place[1] * place[1])
    radius = focal * wp.atan2(aside, -place[2])
    share = radius / wp.max(aside, 1.0e-9)
    return wp.vec2(place[0] * share, -place[1] * share)


@wp.func
def between_pixels(picture: wp.array3d[wp.vec3], world: int, row: float, column: float) -> wp.vec3:
    """Return a picture's value between its pixels; beyond the edge, that of the edge."""
    y = wp.clamp(row, 0.0, float(picture.shape[1] - 1))
    x = wp.clamp(column, 0.0, float(picture.shape[2] - 1))
    i = wp.min(int(y), picture.shape[1] - 2)
    j = wp.min(int(x), picture.shape[2] - 2)
    i = wp.max(i, 0)
    j = wp.max(j, 0)
    below = wp.min(i + 1, picture.shape[1] - 1)
    right = wp.min(j + 1, picture.shape[2] - 1)
    dy = y - float(i)
    dx = x - float(j)
    upper = picture[world, i, j] * (1.0 - dx) + picture[world, i, right] * dx
    lower = picture[world, below, j] * (1.0 - dx) + picture[world, below, right] * dx
    return upper * (1.0 - dy) + lower * dy


@wp.kernel
def smear(
    radiance: wp.array3d[wp.vec3],
    depth: wp.array3d[float],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    motion: wp.array[wp.spatial_vector],
    gain: wp.array[float],
    shutter: wp.vec3,
    focal: float,
    drawn: wp.array[wp.bool],
    out: wp.array3d[wp.vec3],
):
    """Average what each pixel sees while the shutter is open. Launch (N, H, W).

    Every pixel looks along its own streak: the camera's motion is even, the wall stands still meanwhile, and what one
    thing hides of another stays as it is in the middle of the exposure.

    Args:
        radiance: Sharp picture, shape (N, H, W).
        depth: Distance along the ray [m], shape (N, H, W).
        rays: Directions in the camera's frame, shape (H, W, S); the first of each pixel is taken.
        covered: Worlds whose lens is covered, shape (N,).
        motion: Velocity [m/s] and spin [rad/s] of the camera in its frame, shape (N,).
        gain: Gain of the exposure, shape (N,).
        shutter: Shortest and longest time [s], and the gain at which it is the longest.
        focal: Pixels a radian.
        drawn: Worlds to draw, shape (N,).
        out: Blurred picture, shape (N, H, W); written.
    """
    world, row, column = wp.tid()
    if not drawn[world]:
        return
    if covered[world]:
        out[world, row, column] = radiance[world, row, column]
        return
    place = rays[row, column, 0] * depth[world, row, column]
    moves = wp.spatial_top(motion[world]) + wp.cross(wp.spatial_bottom(motion[world]), place)
    time = exposure_time(gain[world], shutter)
    middle = pixel_of(place, focal)
    total = wp.vec3(0.0)
    for moment in range(MOMENTS):
        later = time * ((float(moment) + 0.5) / float(MOMENTS) - 0.5)
        away = pixel_of(place + moves * later, focal) - middle
        total += between_pixels(radiance, world, float(row) + away[1], float(column) + away[0])
    out[world, row, column] = total / float(MOMENTS)
