# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the distance to a surface."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

FAR = wp.constant(10.0)
"""Distance beyond which nothing is looked for [m]."""
INSIDE = wp.constant(0.3)
"""Winding number from which a point is inside: in the plane of the open anus it is a half."""
ACCURACY = wp.constant(2.0)
"""Accuracy of the winding number, as Warp's own."""
OPEN = wp.constant(0.08)
"""Distance from an open end within which the winding number is not the same on all of one side [m]."""
SAME_SIDE = wp.constant(0.99)
"""Share of a point's distance to the mesh within which all is on its side."""


@wp.func
def signed_distance(mesh: wp.uint64, point: wp.vec3) -> float:
    """Return the distance of a point to the mesh, positive inside by the winding number [m]."""
    found = wp.mesh_query_point_sign_winding_number(mesh, point, FAR, ACCURACY, INSIDE)
    nearest = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
    return -found.sign * wp.length(nearest - point)


@wp.kernel
def signed_distances(mesh: wp.uint64, points: wp.array[wp.vec3], out: wp.array[float]):
    """Distance of each point to the mesh, positive inside by the winding number [m]. Launch (n,)."""
    i = wp.tid()
    out[i] = signed_distance(mesh, points[i])


@wp.kernel
def least_signed_distances(
    mesh: wp.uint64, points: wp.array2d[wp.vec3], chain: int, ends: wp.array[wp.vec3], out: wp.array[float]
):
    """Least of :func:`signed_distances` of each group of points [m]. Launch (n,).

    Points come in chains of ``chain``. A point that is nearer than the wall to the one before it, the first of a chain
    to that of the first chain, is on the same side, so that its side, and a distance beyond the least so far, need not
    be found; but for what is near an open end of the mesh.
    """
    i = wp.tid()
    least, first, own = float(FAR), float(0.0), float(0.0)
    for k in range(points.shape[1]):
        point = points[i, k]
        if k % chain == 0:
            step, own = wp.length(point - points[i, 0]), first
        else:
            step = wp.length(point - points[i, k - 1])
        same = step < SAME_SIDE * own
        for e in range(2):
            same = same and wp.length(point - ends[e]) > OPEN
        if same:
            limit = wp.max(least, 1.1 * step)
            found = wp.mesh_query_point_no_sign(mesh, point, limit)
            own = limit
            if found.result:
                nearest = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
                own = wp.length(nearest - point)
        else:
            own = signed_distance(mesh, point)
        least = wp.min(least, own)
        if k == 0:
            first = own
    out[i] = least


@wp.kernel
def distances(mesh: wp.uint64, points: wp.array[wp.vec3], out: wp.array[float]):
    """Distance of each point to the nearest triangle of the mesh [m]. Launch (n,)."""
    i = wp.tid()
    found = wp.mesh_query_point_no_sign(mesh, points[i], FAR)
    out[i] = wp.length(wp.mesh_eval_position(mesh, found.face, found.u, found.v) - points[i])


@wp.kernel
def any_nearer(mesh: wp.uint64, points: wp.array2d[wp.vec3], limit: wp.array[float], out: wp.array[bool]):
    """Whether a point of each group lies within a distance of the mesh [m], on whatever side. Launch (n,)."""
    i = wp.tid()
    out[i] = False
    for k in range(points.shape[1]):
        found = wp.mesh_query_point_no_sign(mesh, points[i, k], limit[i])
        if found.result:
            nearest = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
            if wp.length(nearest - points[i, k]) <= limit[i]:
                out[i] = True
                return
