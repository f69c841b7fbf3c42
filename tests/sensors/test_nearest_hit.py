# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rays that meet an edge: which of its two triangles counts."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from arcgym.sensors.shading_kernels import SurfaceView, nearest_hit

EDGE = [[0.0, -1.0, 1.0], [0.0, 1.0, 1.0]]
RIGHT, LEFT = [1.0, 0.0, 2.0], [-1.0, 0.0, 2.0]
"""A ridge that comes down on the lens at the origin, along Y at a distance of 1 m, with a face on either side."""


@wp.kernel
def shoot(surface: SurfaceView, directions: wp.array[wp.vec3], asked: bool, side: wp.array[float]):
    """Write the X of the corner beside the edge of the triangle that each ray counts for; 0 where it meets none."""
    ray = wp.tid()
    direction = directions[ray]
    face = wp.int32(-1)
    if asked:
        face = nearest_hit(surface, 0, wp.vec3(0.0), direction, 10.0).face
    else:
        query = wp.mesh_query_ray(surface.mesh, wp.vec3(0.0), direction, 10.0, surface.roots[0])
        if query.result:
            face = query.face
    side[ray] = 0.0
    if face >= 0:
        side[ray] = wp.mesh_get_point(surface.mesh, face * 3)[0]


def sides(order: list[int], xs: list[float], asked: bool = True) -> list[float]:
    """Return for rays to (x, y, 1) which face they meet: 1 for the right one, -1 for the left one."""
    faces = np.array([[2, 0, 1], [3, 1, 0]])[order]
    points = wp.array(np.array([*EDGE, RIGHT, LEFT]), dtype=wp.vec3, device="cpu")
    mesh = wp.Mesh(points, wp.array(faces.ravel(), dtype=int, device="cpu"), bvh_leaf_size=4)
    surface = SurfaceView()
    surface.mesh, surface.roots = mesh.id, wp.array([-1], dtype=int, device="cpu")
    ends = np.array([[x, y, 1.0] for x in xs for y in (-0.1, 0.3, 0.8)])
    directions = wp.array(ends / np.linalg.norm(ends, axis=1)[:, None], dtype=wp.vec3, device="cpu")
    out = wp.zeros(len(ends), dtype=float, device="cpu")
    wp.launch(shoot, len(ends), inputs=[surface, directions, asked], outputs=[out], device="cpu")
    return out.numpy().tolist()


def test_the_first_of_two_triangles_counts_for_a_plain_query() -> None:
    assert sides([0, 1], [0.0], asked=False) == [1.0] * 3
    assert sides([1, 0], [0.0], asked=False) == [-1.0] * 3


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_a_ray_to_an_edge_counts_for_the_same_triangle_in_any_order(order: list[int]) -> None:
    assert sides(order, [0.0]) == [1.0] * 3  # moved aside towards positive X


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_a_ray_beside_an_edge_counts_for_its_own_triangle(order: list[int]) -> None:
    assert sides(order, [-1.0e-3, 1.0e-3]) == [-1.0] * 3 + [1.0] * 3
