# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the way along the lumen: a taut band that keeps off the wall. W worlds, K points of the band."""

import warp as wp

from arcgym.sim.contact.lumen_kernels import LumenSurface
from arcgym.sim.geometry_kernels import closest_on_triangle, triangle_point
from arcgym.utils import warp_setup  # noqa: F401

SMOOTHING = wp.constant(0.7)
"""Share of the way to the middle of its neighbors that a point moves in one sweep."""
MOST_PUSH = wp.constant(0.004)
"""Largest way that a point is pushed off the wall in one sweep [m]."""


@wp.func
def off_wall(
    p: wp.vec3, x: wp.array2d[wp.vec3], surface: LumenSurface, first: int, last: int, w: int, far: float
) -> wp.vec4:
    """Return the direction from the nearest face of some rings to ``p``, into the lumen, and the signed distance [m].

    The distance is negative behind the wall. Faces are those of the rings ``first`` to ``last``.
    """
    nearest = far
    away = wp.vec3(0.0)
    outside = float(1.0)
    start = surface.patch_start[surface.ring_patch[first]]
    end = surface.patch_start[surface.ring_patch[last + 1]]
    for f in range(start, end):
        a = x[surface.faces[f, 0], w]
        b = x[surface.faces[f, 1], w]
        c = x[surface.faces[f, 2], w]
        d = p - triangle_point(a, b, c, closest_on_triangle(a, b, c, p))
        gap = wp.length(d)
        if gap < nearest:
            nearest = gap
            away = d
            outside = wp.where(wp.dot(d, wp.cross(b - a, c - a)) > 0.0, -1.0, 1.0)
    away = outside * away / wp.max(nearest, 1.0e-6)
    return wp.vec4(away[0], away[1], away[2], outside * nearest)


@wp.kernel
def measure_room(
    points: wp.array2d[wp.vec3],
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    ring: wp.array[int],
    behind: int,
    last_ring: wp.array[int],
    clearance: float,
    room: wp.array2d[float],
):
    """Distance that each point shall keep from the wall: 80 % of what it has, ``clearance`` at most. Launch (W, K)."""
    w, k = wp.tid()
    first = wp.max(ring[w] - behind, 0)
    last = wp.min(last_ring[w], surface.ring_patch.shape[0] - 2)
    gap = off_wall(points[w, k], x, surface, first, last, w, 1.0)[3]
    room[w, k] = wp.clamp(0.8 * gap, 0.0, clearance)


@wp.kernel
def pull_taut(
    points: wp.array2d[wp.vec3],
    tip: wp.array[wp.vec3],
    x: wp.array2d[wp.vec3],
    surface: LumenSurface,
    ring: wp.array[int],
    behind: int,
    last_ring: wp.array[int],
    room: wp.array2d[float],
    out: wp.array2d[wp.vec3],
):
    """Move each point between its neighbors, then off the wall; the last one is only moved off. Launch (W, K)."""
    w, k = wp.tid()
    first = wp.max(ring[w] - behind, 0)
    last = wp.min(last_ring[w], surface.ring_patch.shape[0] - 2)
    p = points[w, k]
    if k < points.shape[1] - 1:
        before = tip[w]
        if k > 0:
            before = points[w, k - 1]
        p = (1.0 - SMOOTHING) * p + 0.5 * SMOOTHING * (before + points[w, k + 1])
    off = off_wall(p, x, surface, first, last, w, 1.0)
    push = wp.clamp(room[w, k] - off[3], 0.0, MOST_PUSH)
    out[w, k] = p + push * wp.vec3(off[0], off[1], off[2])
