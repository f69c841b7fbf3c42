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


@wp.kernel
def signed_distances(mesh: wp.uint64, points: wp.array[wp.vec3], out: wp.array[float]):
    """Distance of each point to the mesh, positive inside by the winding number [m]. Launch (n,)."""
    i = wp.tid()
    found = wp.mesh_query_point_sign_winding_number(mesh, points[i], FAR, ACCURACY, INSIDE)
    nearest = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
    out[i] = -found.sign * wp.length(nearest - points[i])


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
