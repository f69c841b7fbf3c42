# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Closest points against drawings on squared paper: the triangle has corners (0,0,0), (4,0,0), (0,4,0)."""

import numpy as np
import pytest

from arcgym.sim.contact.contact_search_kernels import beyond_reach
from arcgym.sim.geometry_kernels import closest_on_triangle, segment_parameter, segment_segment, segment_triangle

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import warp as wp

A, B, C = wp.constant(wp.vec3(0.0, 0.0, 0.0)), wp.constant(wp.vec3(4.0, 0.0, 0.0)), wp.constant(wp.vec3(0.0, 4.0, 0.0))


@wp.kernel
def measure(
    p: wp.vec3,
    q: wp.vec3,
    point: wp.array(dtype=wp.vec3),
    parameters: wp.array(dtype=wp.vec3),
    touch: wp.array(dtype=wp.vec4),
):
    point[0] = closest_on_triangle(A, B, C, p)
    both = segment_segment(p, q, A, B)
    parameters[0] = wp.vec3(segment_parameter(A, p, q), both[0], both[1])
    touch[0] = segment_triangle(p, q, A, B, C)


def measured(p: tuple, q: tuple = (9.0, 9.0, 9.0)) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Barycentric point closest to p; parameters (A on pq, pq against AB on either); touch of pq with the triangle."""
    outputs = [wp.zeros(1, dtype=kind, device="cpu") for kind in (wp.vec3, wp.vec3, wp.vec4)]
    wp.launch(measure, 1, [wp.vec3(*p), wp.vec3(*q), *outputs], device="cpu")
    point, parameters, touch = (array.numpy()[0] for array in outputs)
    return point, parameters, touch


@pytest.mark.parametrize(
    ("p", "expected"),
    [
        ((1.0, 1.0, 5.0), (0.5, 0.25, 0.25)),  # above the inside
        ((-1.0, -1.0, 0.0), (1.0, 0.0, 0.0)),  # beyond corner A
        ((6.0, -1.0, 2.0), (0.0, 1.0, 0.0)),  # beyond corner B
        ((-2.0, 7.0, 0.0), (0.0, 0.0, 1.0)),  # beyond corner C
        ((1.0, -3.0, 0.0), (0.75, 0.25, 0.0)),  # beside AB
        ((-3.0, 1.0, 0.0), (0.75, 0.0, 0.25)),  # beside AC
        ((4.0, 4.0, 1.0), (0.0, 0.5, 0.5)),  # beside BC
    ],
)
def test_closest_point_of_a_triangle(p: tuple, expected: tuple) -> None:
    np.testing.assert_allclose(measured(p)[0], expected, atol=1e-6)


def test_parameter_on_a_segment_is_a_share_of_its_length() -> None:
    # The origin lies beside the point (0, 2, 0), a quarter of the way from (-1, 2, 0) to (3, 2, 0).
    assert measured((-1.0, 2.0, 0.0), (3.0, 2.0, 0.0))[1][0] == pytest.approx(0.25)
    assert measured((1.0, 2.0, 0.0), (3.0, 2.0, 0.0))[1][0] == 0.0


def test_crossing_segments_meet_where_they_cross() -> None:
    # AB from (1, -1, 2) to (1, 3, 2): passes over (1, 0, 0), a quarter along either segment.
    np.testing.assert_allclose(measured((1.0, -1.0, 2.0), (1.0, 3.0, 2.0))[1][1:], (0.25, 0.25), atol=1e-6)


def test_parallel_segments_stay_within_their_ends() -> None:
    # From (6, 1, 0) to (8, 1, 0), beyond B: the near end against B.
    np.testing.assert_allclose(measured((6.0, 1.0, 0.0), (8.0, 1.0, 0.0))[1][1:], (0.0, 1.0), atol=1e-6)


@pytest.mark.parametrize(
    ("p", "q", "expected"),
    [
        ((1.0, 1.0, 2.0), (1.0, 1.0, 6.0), (0.5, 0.25, 0.25, 2.0)),  # upright, its foot over the inside
        ((2.0, -3.0, -1.0), (2.0, -3.0, 1.0), (0.5, 0.5, 0.0, 3.0)),  # passes beside AB
        ((-3.0, -4.0, 0.0), (-6.0, -8.0, 0.0), (1.0, 0.0, 0.0, 5.0)),  # 3-4-5 away from A
    ],
)
def test_touch_of_a_segment_with_a_triangle(p: tuple, q: tuple, expected: tuple) -> None:
    np.testing.assert_allclose(measured(p, q)[2], expected, atol=1e-6)


@wp.kernel
def reach_triangles(corners: wp.array2d[wp.vec3], axis: wp.vec3, limit: float, out: wp.array[wp.vec2]):
    k = wp.tid()
    a, b, c = corners[k, 0], corners[k, 1], corners[k, 2]
    distance = segment_triangle(-axis, axis, a, b, c)[3]
    out[k] = wp.vec2(distance, float(beyond_reach(a, b, c, axis, limit)))


def test_what_is_beyond_reach_is_no_contact() -> None:
    """Triangles of 8 mm, up to 3 cm from a link of 12.5 mm: most of those beyond 9 mm are told at once."""
    rng, limit = np.random.default_rng(3), 0.009
    corners = rng.uniform(-0.03, 0.03, (20000, 1, 3)) + rng.uniform(-0.004, 0.004, (20000, 3, 3))
    out = wp.zeros(len(corners), dtype=wp.vec2, device="cpu")
    inputs = [wp.array(corners, dtype=wp.vec3, device="cpu"), wp.vec3(0.0, 0.0, 0.00625), limit]
    wp.launch(reach_triangles, len(corners), inputs=inputs, outputs=[out], device="cpu")
    distance, beyond = out.numpy().T
    assert distance[beyond > 0.0].min() >= limit
    assert (beyond[distance > limit] > 0.0).mean() > 0.95
