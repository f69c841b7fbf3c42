# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Whether points are inside the lumen."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

INV_TWO_PI = wp.constant(1.0 / (2.0 * wp.pi))


@wp.kernel
def winding_number(
    points: wp.array2d(dtype=wp.vec3),
    triangles: wp.array(dtype=wp.vec3i),
    centers: wp.array2d(dtype=wp.vec3),
    winding: wp.array2d(dtype=float),
):
    """Count how often the surface winds around each center. Launch (W, L).

    Solid angles as in van Oosterom and Strackee 1983.
    """
    w, i = wp.tid()
    p = centers[w, i]
    total = float(0.0)
    for k in range(triangles.shape[0]):
        a = points[w, triangles[k][0]] - p
        b = points[w, triangles[k][1]] - p
        c = points[w, triangles[k][2]] - p
        la = wp.length(a)
        lb = wp.length(b)
        lc = wp.length(c)
        volume = wp.dot(a, wp.cross(b, c))
        dots = wp.dot(a, b) * lc + wp.dot(b, c) * la + wp.dot(c, a) * lb
        total += wp.atan2(volume, la * lb * lc + dots)
    winding[w, i] = total * INV_TWO_PI
