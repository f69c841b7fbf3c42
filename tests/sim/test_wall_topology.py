# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Lumen faces of the tiny tube: 17 rings of 8 vertices, closed at the end."""

from __future__ import annotations

import numpy as np
import pytest
from tiny import tiny_colon_stage

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.stage.types import WallMesh
from arcgym.sim.wall.wall_topology import LumenTopology, face_neighbors, lumen_topology, members, vertex_entries

RINGS, SECTORS = 17, 8


@pytest.fixture(scope="module")
def wall() -> WallMesh:
    return tiny_colon_stage().wall


@pytest.fixture(scope="module")
def lumen(wall: WallMesh) -> LumenTopology:
    return lumen_topology(wall.points, inner_faces(wall.tets, wall.layer), wall.ring, wall.layer)


def test_faces_are_sorted_by_their_lowest_ring(wall: WallMesh, lumen: LumenTopology) -> None:
    lowest = wall.ring[lumen.faces].min(axis=1)
    assert (np.diff(lowest) >= 0).all()
    for ring in range(RINGS):
        assert (lowest[lumen.ring_start[ring] : lumen.ring_start[ring + 1]] == ring).all()


def test_each_band_has_two_faces_a_sector_and_the_cap_two_fewer_than_sectors(lumen: LumenTopology) -> None:
    np.testing.assert_array_equal(np.diff(lumen.ring_start), [2 * SECTORS] * (RINGS - 1) + [SECTORS - 2])


def test_normals_point_from_the_lumen_into_the_wall(wall: WallMesh, lumen: LumenTopology) -> None:
    tube = lumen.faces[: lumen.ring_start[RINGS - 1]]
    a, b, c = (wall.points[tube[:, k]] for k in range(3))
    radial = (a + b + c) * [1.0, 1.0, 0.0]
    assert (np.einsum("fi,fi->f", np.cross(b - a, c - a), radial) > 0).all()


def test_neighbor_shares_the_edge_opposite_to_the_corner(lumen: LumenTopology) -> None:
    for face, row in enumerate(lumen.neighbors):
        for corner, other in enumerate(row):
            if other >= 0:
                edge = set(np.delete(lumen.faces[face], corner))
                assert edge < set(lumen.faces[other])
                assert face in lumen.neighbors[other]


def test_only_the_rim_at_the_anus_has_no_neighbors(lumen: LumenTopology) -> None:
    # The blind end is closed, so just the 8 edges of the first ring are open.
    assert (lumen.neighbors < 0).sum() == SECTORS


def test_neighbors_of_two_triangles() -> None:
    faces = np.array([[0, 1, 2], [2, 1, 3]])
    np.testing.assert_array_equal(face_neighbors(faces), [[1, -1, -1], [-1, -1, 0]])


def test_patches_split_each_ring_into_compact_pieces(wall: WallMesh, lumen: LumenTopology) -> None:
    # 16 faces of a ring in patches of 6, 6 and 4; six neighboring faces reach around at most 3 + 1 of the 8 sectors.
    assert lumen.ring_patch[-1] == len(lumen.patch_start) - 1 and lumen.patch_start[-1] == len(lumen.faces)
    np.testing.assert_array_equal(lumen.patch_start[lumen.ring_patch], lumen.ring_start)
    for first, last in zip(lumen.patch_start[:-3], lumen.patch_start[1:-2], strict=True):
        corners = wall.points[np.unique(lumen.faces[first:last]), :2]
        widest = np.linalg.norm(corners[:, None] - corners, axis=2).max()
        assert widest <= 2 * 0.020 * np.sin(0.5 * 4 * 2 * np.pi / SECTORS) + 1e-6


def test_members_pads_short_rings() -> None:
    ring = np.array([0, 0, 0, 1])
    np.testing.assert_array_equal(members(np.arange(4), ring, 2, pad_first=True), [[0, 1, 2], [3, 3, 3]])
    np.testing.assert_array_equal(members(np.arange(4), ring, 2, pad_first=False), [[0, 1, 2], [3, -1, -1]])


def test_a_ring_without_vertices_is_named() -> None:
    with pytest.raises(ValueError, match=r"rings \[1\] have no vertices.*from 0 to 2"):
        members(np.arange(2), np.array([0, 2]), 3, pad_first=True)


def test_entries_list_the_tets_around_each_vertex() -> None:
    start, entry = vertex_entries(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]), 5)
    np.testing.assert_array_equal(start, [0, 1, 3, 5, 7, 8])
    assert list(entry[start[3] : start[4]]) == [3, 4 + 2]
