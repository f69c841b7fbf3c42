# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Which side of a face a link is on."""

import pytest

from arcgym.sim.contact.contact_kernels import contact_geometry
from arcgym.sim.contact.contact_record_kernels import ClosestPoint, side_normal
from arcgym.sim.contact.contact_search_kernels import on_lumen_side
from arcgym.sim.geometry_kernels import segment_triangle, triangle_point

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import warp as wp

A, B, C = wp.constant(wp.vec3(0.0, 0.0, 0.0)), wp.constant(wp.vec3(4.0, 0.0, 0.0)), wp.constant(wp.vec3(0.0, 4.0, 0.0))
"""Corners of a face, its normal along +Z."""


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


@wp.kernel
def measure_gap(distance: float, nearest: float, gap: wp.array(dtype=float)):
    """Gap of a link of radius 1 at the origin to the face ``distance`` along +X that has the link behind it."""
    point = ClosestPoint()
    point.direction = wp.vec3(1.0, 0.0, 0.0)
    point.normal = wp.vec3(-1.0, 0.0, 0.0)
    normal = side_normal(point, distance, nearest, 1.0)
    gap[0] = contact_geometry(wp.vec3(distance, 0.0, 0.0), normal, wp.transform_identity(), 0.0, 1.0).gap


@pytest.mark.parametrize(
    ("distance", "nearest", "gap"),
    [
        (0.2, 0.2, -1.2),  # it went through this face, whose contact has to push it back by that much
        (0.4, 0.2, -1.4),  # the next face of the same wall
        (0.9, 0.2, -0.1),  # the far side of a fold: the link touches it from outside
        (0.3, 0.3, -0.7),  # clear of the wall
    ],
)
def test_a_link_has_gone_through_no_face_that_is_far_from_its_axis(distance: float, nearest: float, gap: float) -> None:
    out = wp.zeros(1, dtype=float, device="cpu")
    wp.launch(measure_gap, 1, [distance, nearest], [out], device="cpu")
    assert out.numpy()[0] == pytest.approx(gap)
