# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Order of triangles in which one tree suits several surfaces."""

from __future__ import annotations

import numpy as np
from tube_scene import tube_visual, tube_wall

from arcgym.sensors.shared_tree import TreeShape, halving_order, sorted_faces


def test_on_a_line_every_triangle_has_a_place_of_its_own() -> None:
    shape = TreeShape(1950, 1000)
    box = shape.points[shape.faces]
    assert (np.diff(0.5 * (box.min(axis=1) + box.max(axis=1))[:, 0]) > 0.0).all()
    assert np.diff(np.append(shape.pieces[-1], 1950)).max() == 2


def test_pieces_are_cut_across_their_longer_side() -> None:
    # A strip of 8 x 2 points is halved along, along, then around.
    places = np.stack(np.meshgrid(np.arange(8.0), np.arange(2.0), indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.random.default_rng(0).permutation(places)
    order = halving_order(places, [np.array([0]), np.array([0, 8]), np.arange(0, 16, 4), np.arange(0, 16, 2)])
    for level, width, height in ((8, 4, 2), (4, 2, 2), (2, 2, 1)):
        for piece in places[order].reshape(-1, level, 2):
            assert sorted(np.ptp(piece, axis=0) + 1) in ([height, width], [width, height])


def test_surfaces_of_any_size_lie_alike_in_the_tree() -> None:
    walls = [tube_wall(), tube_wall(radius=0.03)]
    visuals = [tube_visual(walls[0]), tube_visual(walls[1], fine=2, radius=0.03)]
    shape = TreeShape(max(len(one.faces) for one in visuals), max(len(one.points) for one in visuals))
    faces = sorted_faces(visuals, walls[0], shape)
    start = next(level for level in shape.pieces if len(level) >= 16)
    middles = []
    for visual, own in zip(visuals, faces, strict=True):
        corners = visual.points[own]
        real = np.ptp(corners, axis=1).max(axis=1) > 0.0
        assert sorted(map(tuple, own[real])) == sorted(map(tuple, visual.faces))
        height = corners[:, :, 2].mean(axis=1)
        middles.append(np.add.reduceat(height, start) / np.diff(np.append(start, len(own))))
    np.testing.assert_allclose(middles[0], middles[1], atol=0.004)
