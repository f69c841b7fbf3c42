# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rings of the wall: their planes, and mass and anchors in their modes."""

from __future__ import annotations

import numpy as np
from tiny import tiny_colon_stage

from arcgym.sim.wall.ring_modes import RingModes, band_elements, ring_modes

WALL = tiny_colon_stage().wall
"""Straight tube of 17 rings of 8 inner and 8 outer vertices, 12.5 mm apart, 20 and 22 mm from the axis."""
POINTS = WALL.points.astype(float)


def modes(mobile: np.ndarray | None = None) -> RingModes:
    """Vertices of 1 g with springs of 2 N/m."""
    count = len(POINTS)
    return ring_modes(
        POINTS, WALL.ring, np.ones(count, bool) if mobile is None else mobile, np.full(count, 1e-3), np.full(count, 2.0)
    )


def test_in_plane_coordinates_are_those_of_the_ring_over_its_size() -> None:
    found = modes()
    ring = WALL.ring == 8
    size = np.sqrt((20.0**2 + 22.0**2) / 2) * 1e-3
    distance = np.linalg.norm(POINTS[ring, :2], axis=1)
    np.testing.assert_allclose(np.linalg.norm(found.plane[ring], axis=1), distance / size, rtol=1e-6)
    np.testing.assert_allclose(found.plane[ring].mean(axis=0), 0.0, atol=1e-7)


def test_neighbors_have_the_same_axes() -> None:
    found = modes()
    first = found.plane[WALL.ring == 0]
    for ring in range(1, 17):
        np.testing.assert_allclose(found.plane[WALL.ring == ring], first, atol=2e-3)


def test_mass_and_anchors_of_a_ring_of_sixteen_vertices() -> None:
    found = modes()  # the means of 1, p^2 + q^2 over the ring are 1, and p, q, p q have the mean 0
    np.testing.assert_allclose(found.mass[8], 16e-3 * np.diag([1.0, 0.5, 0.5]), atol=1e-8)
    np.testing.assert_allclose(found.anchor[8], 32.0 * np.diag([1.0, 0.5, 0.5]), atol=1e-5)


def test_bending_of_even_rings() -> None:
    """With 2 D (du / h)^2 2 / h around 2 pi R: 4 pi R / h^3 between twice the widenings, half between the flattenings.

    ``WALL`` has two layers, 20 and 22 mm from the axis, whose vertices share the circumference.
    """
    size = np.sqrt((20.0**2 + 22.0**2) / 2) * 1e-3
    factor = modes().bending[8]
    expected = 4.0 * np.pi * size / 0.0125**3 * np.diag([1.0, 0.5, 0.5])
    np.testing.assert_allclose(factor @ factor.T, expected, rtol=1e-4, atol=1e-3 * expected[0, 0])


def test_bending_is_larger_where_rings_crowd_inside_a_bend() -> None:
    wall = tiny_colon_stage(bend=2.0).wall
    count = len(wall.points)
    bent = ring_modes(wall.points, wall.ring, np.ones(count, bool), np.ones(count), np.ones(count))
    straight = modes()
    largest = [np.linalg.eigvalsh(m.bending[8] @ m.bending[8].T)[-1] for m in (bent, straight)]
    assert largest[0] > 1.01 * largest[1]


def test_a_ring_with_one_held_vertex_does_not_move_as_a_whole() -> None:
    mobile = np.ones(len(POINTS), bool)
    mobile[np.flatnonzero(WALL.ring == 5)[0]] = False
    assert np.flatnonzero(~modes(mobile).moves).tolist() == [5]


def test_elements_by_band() -> None:
    ring = np.array([0, 0, 1, 1, 2, 2])
    elements = np.array([[2, 3, 4], [0, 1, 2], [4, 5, 4], [1, 2, 3], [0, 1, 0]])
    start, order = band_elements(elements, ring)  # the third lies in the last ring, the fifth in the first
    assert [order[a:b].tolist() for a, b in zip(start[:-1], start[1:], strict=True)] == [[1, 3, 4], [0, 2], []]


def test_an_element_over_three_rings_is_left_out() -> None:
    start, order = band_elements(np.array([[0, 1, 2], [0, 1, 1]]), np.array([0, 1, 2]))
    assert start.tolist() == [0, 1, 1, 1] and order.tolist() == [1]
