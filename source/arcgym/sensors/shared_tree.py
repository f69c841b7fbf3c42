# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Order of the triangles of several patients' surfaces in which one ray tree suits all of them, in numpy.

The unrolled surface of each patient is halved again and again, across its longer side, with equally many triangles in
either half. A tree that halves the numbers of the triangles then has one piece of surface in every node, whichever
patient a world has, and as small ones as a tree of that patient alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from arcgym.anatomy.shell import ShellMesh
    from arcgym.anatomy.stage import VisualMesh, WallMesh

CIRCUMFERENCE = 0.14
"""Length around the colon for its length along it [m]: that of a lumen of 45 mm."""
SMALLEST = 2
"""Triangles in the smallest pieces."""


class TreeShape:
    """Points and triangles of which a tree builder makes a tree that halves the triangles' numbers again and again."""

    def __init__(self, faces: int, vertices: int):
        """Place the triangles on a line, which a builder halves between triangles.

        Args:
            faces: Number of triangles F of a world.
            vertices: Number of vertices M of a world, at least half of F.
        """
        index = np.arange(faces)
        vertex = index * vertices // faces
        again = np.diff(vertex, prepend=-1) == 0
        self.faces = np.repeat(vertex, 3).reshape(-1, 3).astype(np.int32)
        """Corners, shape (F, 3), int32."""
        self.faces[again, 2] = np.minimum(self.faces[again, 2] + 1, vertices - 1)  # half a step further on
        self.points = np.zeros((vertices, 3), np.float32)
        """Points [m], shape (M, 3)."""
        self.points[:, 0] = np.arange(vertices)
        self.pieces = _halves(faces)
        """First triangle of each piece that a node of the tree holds, level by level."""


def _halves(count: int) -> list[np.ndarray]:
    """Return the first of each piece where pieces are halved down to two or less, level by level."""
    levels = [np.array([0])]
    while (size := np.diff(np.append(levels[-1], count))).max() > SMALLEST:
        start = levels[-1]
        middle = (start + size // 2)[size > SMALLEST]
        levels.append(np.sort(np.append(start, middle)))
    return levels


def sorted_faces(visuals: Sequence[VisualMesh], wall: ShellMesh | WallMesh, shape: TreeShape) -> np.ndarray:
    """Sort the triangles of each patient, and fill up to equally many.

    Args:
        visuals: Surfaces, skinned to walls on one grid.
        wall: One of those walls.
        shape: The tree.

    Returns:
        Corners, shape (P, F, 3), int32; those that fill up are a corner of some triangle three times.
    """
    with ThreadPoolExecutor() as pool:
        return np.stack(list(pool.map(lambda visual: _sorted(visual, wall, shape), visuals)))


def _sorted(visual: VisualMesh, wall: ShellMesh | WallMesh, shape: TreeShape) -> np.ndarray:
    """Return the triangles of one patient in order, filled up to those of the tree, shape (F, 3)."""
    count = len(shape.faces)
    own = np.arange(count) * len(visual.faces) // count
    faces = visual.faces[own].astype(np.int32)
    repeated = np.diff(own, prepend=-1) == 0
    faces[repeated] = faces[repeated][:, :1]
    return faces[halving_order(_unrolled(visual, wall)[own], shape.pieces)]


def halving_order(places: np.ndarray, pieces: Sequence[np.ndarray]) -> np.ndarray:
    """Return the order in which the places of every piece are a piece of the plane, cut across its longer side.

    Args:
        places: Places in the plane, shape (n, 2).
        pieces: First place of each piece, level by level; every level divides the pieces of the one before.

    Returns:
        Indices, shape (n,).
    """
    order = np.arange(len(places))
    for start in pieces:
        piece = np.repeat(np.arange(len(start)), np.diff(np.append(start, len(places))))
        now = places[order]
        size = np.maximum.reduceat(now, start, axis=0) - np.minimum.reduceat(now, start, axis=0)
        key = np.where(size[piece, 0] >= size[piece, 1], now[:, 0], now[:, 1])
        order = order[np.lexsort((key, piece))]
    return order


def _unrolled(visual: VisualMesh, wall: ShellMesh | WallMesh) -> np.ndarray:
    """Return the place of each triangle along the colon and around it [m], shape (F, 2)."""
    angle = 2.0 * np.pi * _sector(wall)[visual.skin_indices]
    weight = visual.skin_weights
    along = (weight * wall.ring_arc[wall.ring[visual.skin_indices]]).sum(axis=1)
    x, y = (weight * np.cos(angle)).sum(axis=1), (weight * np.sin(angle)).sum(axis=1)
    corners = visual.faces
    turn = np.arctan2(y[corners].mean(axis=1), x[corners].mean(axis=1)) / (2.0 * np.pi)
    return np.stack([along[corners].mean(axis=1), CIRCUMFERENCE * turn], axis=1)


def _sector(wall: ShellMesh | WallMesh) -> np.ndarray:
    """Return how far around its ring each wall vertex is, by its number in it, 0 to 1, shape (V,)."""
    out = np.zeros(len(wall.ring))
    group = wall.ring * (int(wall.layer.max()) + 1) + wall.layer
    for key in np.unique(group):
        own = np.flatnonzero(group == key)
        out[own] = np.arange(len(own)) / len(own)
    return out
