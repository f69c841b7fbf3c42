# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The wall of a grid: its elements follow from the grid alone."""

from __future__ import annotations

import numpy as np
from tiny import tube_points

from arcgym.anatomy.measures import inner_faces, tet_volumes
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.stage.types import WallMesh


def wall_of(dent: float = 0.0) -> WallMesh:
    """A tube of 20 mm radius, 5 rings of 8; ``dent`` moves one vertex of the outer layer inwards [m]."""
    theta, arc = np.arange(8) * 2 * np.pi / 8, np.linspace(0.0, 0.04, 5)
    layers = np.stack([tube_points(arc, theta, radius, 0.04, 0.0) for radius in (0.020, 0.022)])
    layers[1, -1, :, 2] += 0.002
    layers[1, 2, 0] *= [1.0 - dent / 0.022, 1.0 - dent / 0.022, 1.0]
    return build_wall(layers, np.zeros(5, int), arc)


def test_all_volumes_are_positive() -> None:
    wall = wall_of()
    assert tet_volumes(wall.points, wall.tets).min() > 0.0


def test_a_wall_turned_inside_out_has_the_same_elements_of_which_some_are_inverted() -> None:
    """Their faces still point into the wall: what touches them and what mends them must know."""
    whole, dented = wall_of(), wall_of(dent=0.012)
    np.testing.assert_array_equal(dented.tets, whole.tets)
    np.testing.assert_array_equal(inner_faces(dented.tets, dented.layer), inner_faces(whole.tets, whole.layer))
    assert tet_volumes(dented.points, dented.tets).min() < 0.0
