# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Topology and intersections on a tetrahedron, and what the stage checks say of broken tubes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tiny import tiny_colon_stage

from arcgym.anatomy.validation import mesh_checks
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.mesh_checks import (
    boundary_faces,
    cap_openings,
    count_crossings,
    edge_uses,
    winding_numbers,
)
from arcgym.anatomy.validation.stage_checks import inspect_stage

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
FACES = boundary_faces(np.array([[0, 1, 2, 3]]))


def test_tetrahedron_is_closed() -> None:
    _, uses = edge_uses(FACES)
    assert len(FACES) == 4 and uses.tolist() == [2] * 6


def test_winding_is_one_inside_and_zero_outside() -> None:
    inside = np.array([[0.1, 0.1, 0.1], [1.0, 1.0, 1.0], [-0.1, 0.1, 0.1]])
    assert winding_numbers(CORNERS, FACES, inside) == pytest.approx([1, 0, 0], abs=1e-9)


def test_capping_closes_what_a_missing_face_opened() -> None:
    closed = cap_openings(FACES[1:])
    assert winding_numbers(CORNERS, closed, np.full((1, 3), 0.1)) == pytest.approx([1])


@pytest.mark.parametrize(("shift", "crosses"), [((0.1, 0.1, 0.2), True), ((2.0, 0.0, 0.0), False)])
def test_two_tetrahedra(shift: tuple[float, float, float], crosses: bool) -> None:
    points = np.concatenate([CORNERS, CORNERS + shift])
    assert (count_crossings(points, np.concatenate([FACES, FACES + 4])) > 0) == crosses


def test_crossings_are_those_of_all_pairs() -> None:
    stage, rng = tiny_colon_stage(), np.random.default_rng(0)
    points, faces = stage.wall.points, boundary_faces(stage.wall.tets)
    points = points + rng.normal(0.0, 0.004, points.shape)
    edges, _ = edge_uses(faces)
    edge, face = (index.ravel() for index in np.indices((len(edges), len(faces))))
    apart = (edges[edge][:, :, None] != faces[face][:, None]).all((1, 2))
    edge, face = edge[apart], face[apart]
    crossing = mesh_checks._crosses(points.astype(float), edges[edge], faces[face])
    expected = np.concatenate([edges[edge[crossing]], faces[face[crossing]]], axis=1)
    assert len(expected) > 10 and np.array_equal(mesh_checks.find_crossings(points, faces), expected)


def test_sound_tube_passes_every_check() -> None:
    assert failed(inspect_stage(tiny_colon_stage())) == []


def test_stage_without_landmarks_is_checked_all_the_same() -> None:
    assert failed(inspect_stage(replace(tiny_colon_stage(), landmarks={}))) == []


def test_wall_pushed_through_the_opposite_side_is_found() -> None:
    """A vertex of ring 8 goes across the lumen (40 mm) and 10 mm out on the other side."""
    wall = tiny_colon_stage().wall
    points = wall.points.copy()
    vertex = np.flatnonzero((wall.ring == 8) & (wall.layer == 0))[0]
    center = points[(wall.ring == 8) & (wall.layer == 0)].mean(0)
    points[vertex] = center - 1.5 * (points[vertex] - center)
    broken = replace(tiny_colon_stage(), wall=replace(wall, points=points))
    assert "self-intersections" in "".join(check.name for check in failed(inspect_stage(broken)))


def test_centerline_beside_the_tube_is_found() -> None:
    stage = tiny_colon_stage()
    beside = replace(stage.centerline, points=stage.centerline.points + np.float32([0.03, 0, 0]))
    names = [check.name for check in failed(inspect_stage(replace(stage, centerline=beside)))]
    assert names == ["centerline points outside the lumen"]


def test_end_ring_that_can_move_is_found() -> None:
    stage = tiny_colon_stage()
    anchor = np.where(stage.wall.ring == 0, 0, stage.wall.anchor).astype(np.int32)
    names = [check.name for check in failed(inspect_stage(replace(stage, wall=replace(stage.wall, anchor=anchor))))]
    assert "anchors: vertices of the end rings that can move" in names
