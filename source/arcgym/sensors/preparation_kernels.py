# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Stool and fluid on the wall, laid into a picture's radiance."""

import warp as wp

from arcgym.sensors.blob_kernels import blob_at
from arcgym.sensors.shading_kernels import SurfaceView, nearest_hit
from arcgym.utils import warp_setup  # noqa: F401

SMALLEST, LARGEST = wp.constant(0.4), wp.constant(0.9)
"""Radii of a lump [cells]."""
CELL = wp.constant(0.02)
"""Cell of space in which a lump of stool may lie [m]."""
MUCOSA = wp.constant(0.26)
"""Luminance of the mean mucosa, linear: what is darker or brighter is lit less or more."""
STOOL = wp.constant(wp.vec3(0.16, 0.075, 0.02))
"""Linear albedo of stool; a choice."""
MURK = wp.constant(wp.vec3(0.30, 0.15, 0.04))
"""Linear albedo of turbid fluid; a choice."""
SHORE = wp.constant(0.06)
"""Width of the edge of a puddle, in the cosine of the wall's slope."""


@wp.struct
class Residue:
    """What is left in the colons. N worlds, P patients, M vertices."""

    rest: wp.array2d[wp.vec4]  # place at rest [m] and part of the colon (right, transverse, left), shape (M, P)
    scores: wp.array2d[int]  # of the three parts, shape (N, 3)
    seed: wp.array[int]  # shape (N,)
    gravity: wp.array[wp.vec3]  # acceleration of free fall [m/s^2], shape (N,)
    grades: wp.array[wp.vec3]  # share of stool, share of liquid and its turbidity, by score, shape (4,)


@wp.func
def under_fluid(normal: wp.vec3, gravity: wp.vec3, share: float) -> float:
    """Return whether a place is under fluid, 0 to 1: in a tube a share of the way around, at the bottom.

    Args:
        normal: Unit normal towards the lumen.
        gravity: Acceleration of free fall.
        share: Share of the way around that lies under fluid.
    """
    if share <= 0.0:
        return 0.0
    upward = -wp.dot(normal, wp.normalize(gravity))
    return wp.clamp((upward - wp.cos(wp.pi * share)) / SHORE + 0.5, 0.0, 1.0)


@wp.kernel
def soil(
    surface: SurfaceView,
    residue: Residue,
    drawn: wp.array[wp.bool],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    far: float,
    radiance: wp.array3d[wp.vec3],
):
    """Cover what a picture shows of the wall with stool and fluid, as bright as the wall there. Launch (N, H, W).

    Args:
        surface: Surface of all worlds.
        residue: What is left in them.
        drawn: Worlds to draw, shape (N,).
        poses: Camera poses, shape (N,).
        rays: Directions in the camera's frame, shape (H, W, S); the first of each pixel is taken.
        covered: Worlds whose lens is covered, shape (N,).
        far: Farthest distance seen [m].
        radiance: Linear radiance, shape (N, H, W); changed.
    """
    world, row, column = wp.tid()
    if not drawn[world] or covered[world]:
        return
    camera = poses[world]
    direction = wp.transform_vector(camera, rays[row, column, 0])
    origin = wp.transform_get_translation(camera)
    hit = nearest_hit(surface, world, origin, direction, far)
    if hit.face < 0:
        return
    i0 = wp.mesh_get_index(surface.mesh, hit.face * 3)
    i1 = wp.mesh_get_index(surface.mesh, hit.face * 3 + 1)
    i2 = wp.mesh_get_index(surface.mesh, hit.face * 3 + 2)
    w2 = 1.0 - hit.u - hit.v
    first = world * residue.rest.shape[0]
    p = surface.patient[world]
    at = residue.rest[i0 - first, p] * hit.u + residue.rest[i1 - first, p] * hit.v + residue.rest[i2 - first, p] * w2
    normal = wp.normalize(surface.normals[i0] * hit.u + surface.normals[i1] * hit.v + surface.normals[i2] * w2)
    grade = residue.grades[residue.scores[world, wp.clamp(int(at[3] + 0.5), 0, 2)]]
    color = radiance[world, row, column]
    light = wp.dot(color, wp.vec3(0.2126, 0.7152, 0.0722)) / MUCOSA
    wet = grade[2] * under_fluid(normal, residue.gravity[world], grade[1])
    color = color * (1.0 - wet) + MURK * (light * wet)
    blob = blob_at(wp.vec3(at[0], at[1], at[2]), CELL, grade[0], SMALLEST, LARGEST, residue.seed[world])
    if blob[0] > 0.0:
        edge = wp.min(blob[0] / 0.15, 1.0)
        color = color * (1.0 - edge) + STOOL * (light * edge * (0.6 + 0.8 * blob[1]))
    radiance[world, row, column] = color
