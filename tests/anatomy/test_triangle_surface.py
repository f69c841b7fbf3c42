# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of edges, and the largest of several surfaces."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.meshing.triangle_surface import edge_ends, edge_keys, largest_part

FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
"""A tetrahedron, normals outwards."""


def test_an_edge_has_one_number_from_both_sides() -> None:
    keys = edge_keys(FACES, 4)
    assert keys[0].tolist() == [2, 6, 1]  # edges 0-2, 1-2 and 0-1 of four vertices
    assert edge_ends(np.unique(keys), 4).tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]


def test_the_part_with_most_triangles_is_kept_and_numbered_anew() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    points = np.concatenate([corners + 5.0, np.full((1, 3), 9.0), corners])
    faces = np.concatenate([FACES[:3], FACES + 5])  # an open tetrahedron, a vertex that nothing uses, a closed one
    kept = largest_part(points, faces)
    assert kept.points.tolist() == corners.tolist()
    assert kept.faces.tolist() == FACES.tolist()
