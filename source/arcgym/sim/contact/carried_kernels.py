# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Points of a fine surface that the wall carries. W worlds, V wall vertices, M points, P patients."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def carry_points(
    x: wp.array2d[wp.vec3],
    index: wp.array[wp.vec4i],
    weight: wp.array[wp.vec4],
    offset: wp.array2d[wp.vec3],
    patient: wp.array[int],
    points: wp.array2d[wp.vec3],
):
    """Move the points with the cells of the wall that carry them. Launch (M, W).

    The offset from the mean of the cell's corners is turned with the cell: by the frame of its mean direction along the
    colon and its normal.

    Args:
        x: Wall positions [m], shape (V, W).
        index: Corners of each point's cell: on the lower ring, on the upper, both again in the next sector, shape (M,).
        weight: Their weights, shape (M,).
        offset: Offset of each point in the frame of its cell [m], shape (M, P).
        patient: Patient of each world, shape (W,).
        points: Positions [m], shape (M, W); written.
    """
    m, w = wp.tid()
    i = index[m]
    u = weight[m]
    a = x[i[0], w]
    b = x[i[1], w]
    c = x[i[2], w]
    d = x[i[3], w]
    along = wp.normalize(b + c - a - d)
    normal = wp.normalize(wp.cross(along, c + d - a - b))
    away = offset[m, patient[w]]
    turned = away[0] * along + away[1] * wp.cross(normal, along) + away[2] * normal
    points[m, w] = u[0] * a + u[1] * b + u[2] * c + u[3] * d + turned
