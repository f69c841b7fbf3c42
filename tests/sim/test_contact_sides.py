# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Which side of a face a link is on. The face has corners (0,0,0), (4,0,0), (0,4,0) and its normal along +Z."""

import pytest

from arcgym.sim.contact.contact_search_kernels import on_lumen_side
from arcgym.sim.geometry_kernels import segment_triangle, triangle_point

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import warp as wp

A, B, C = wp.constant(wp.vec3(0.0, 0.0, 0.0)), wp.constant(wp.vec3(4.0, 0.0, 0.0)), wp.constant(wp.vec3(0.0, 4.0, 0.0))


@wp.kernel
def judge(p: wp.vec3, q: wp.vec3, side: wp.array(dtype=int)):
    center = 0.5 * (p + q)
    axis = 0.5 * (q - p)
    a, b, c = A - center, B - center, C - center
    u = segment_triangle(-axis, axis, a, b, c)
    near = triangle_point(a, b, c, wp.vec3(u[0], u[1], u[2]))
    side[0] = int(on_lumen_side(a, b, c, wp.cross(b - a, c - a), near, axis))


@pytest.mark.parametrize(
    ("p", "q", "lumen"),
    [
        ((1.0, 1.0, -1.0), (1.0, 1.0, -3.0), True),  # the normal points away from all of it
        ((1.0, 1.0, 1.0), (1.0, 1.0, 3.0), False),
        ((1.0, 1.0, -1.0), (1.0, 1.0, 0.5), True),  # goes through the face, its middle below
        ((1.0, 1.0, -1.0), (1.0, 1.0, 3.0), False),
        ((-1.0, 2.0, -0.5), (-9.0, 2.0, 8.0), True),  # its middle is above the plane, the end beside the face below
        ((-1.0, 2.0, 0.5), (-9.0, 2.0, -8.0), False),
    ],
)
def test_the_nearest_point_of_the_axis_decides(p: tuple, q: tuple, lumen: bool) -> None:
    side = wp.zeros(1, dtype=int, device="cpu")
    wp.launch(judge, 1, [wp.vec3(*p), wp.vec3(*q)], [side], device="cpu")
    assert bool(side.numpy()[0]) == lumen
