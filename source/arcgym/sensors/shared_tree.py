# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Order of the triangles of several patients' surfaces in which one ray tree suits all of them, in numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from arcgym.anatomy.shell import ShellMesh
    from arcgym.anatomy.stage import VisualMesh, WallMesh

AROUND = 128
"""Steps around the colon of the curve along which triangles are sorted; along it they are about as long."""
SPACING = 0.001
"""Step along the colon [m]."""


def sorted_faces(visuals: Sequence[VisualMesh], wall: ShellMesh | WallMesh) -> np.ndarray:
    """Sort the triangles of each patient along a curve over the colon's surface, and fill up to equally many.

    Triangles of the same number then lie at about the same place of the colon, and triangles of neighboring numbers
    side by side, in every patient: a tree over the numbers encloses them tightly whichever patient a world has.

    Args:
        visuals: Surfaces, skinned to walls on one grid.
        wall: One of those walls.

    Returns:
        Corners, shape (P, F, 3), int32; those that fill up are the last triangle's first corner three times.
    """
    faces = [visual.faces[np.argsort(_curve(visual, wall), kind="stable")] for visual in visuals]
    out = np.empty((len(faces), max(map(len, faces)), 3), np.int32)
    for row, own in zip(out, faces, strict=True):
        row[: len(own)] = own
        row[len(own) :] = own[-1, 0]
    return out


def curve_points(count: int) -> np.ndarray:
    """Return points whose order along a Z-order curve in space is their own, shape (count, 3), float32."""
    bits = max(count - 1, 1).bit_length()
    index = (
        np.arange(count) * (1 << bits) // count
    )  # up to the last corner of the cube, whose sides tree builders halve
    out = np.zeros((count, 3), np.float32)
    for bit in range(bits):
        out[:, bit % 3] += ((index >> bit) & 1) << (bit // 3)
    return out


def _curve(visual: VisualMesh, wall: ShellMesh | WallMesh) -> np.ndarray:
    """Return the place of each triangle along a Z-order curve over the unrolled surface, shape (F,)."""
    angle = 2.0 * np.pi * _sector(wall)[visual.skin_indices]
    weight = visual.skin_weights
    along = (weight * wall.ring_arc[wall.ring[visual.skin_indices]]).sum(axis=1)
    x, y = (weight * np.cos(angle)).sum(axis=1), (weight * np.sin(angle)).sum(axis=1)
    corners = visual.faces
    turn = np.arctan2(y[corners].mean(axis=1), x[corners].mean(axis=1)) / (2.0 * np.pi) + 0.5
    row = np.maximum(along[corners].mean(axis=1) / SPACING, 0.0).astype(np.int64)
    return _interleaved(row, np.minimum((turn * AROUND).astype(np.int64), AROUND - 1))


def _sector(wall: ShellMesh | WallMesh) -> np.ndarray:
    """Return how far around its ring each wall vertex is, by its number in it, 0 to 1, shape (V,)."""
    out = np.zeros(len(wall.ring))
    group = wall.ring * (int(wall.layer.max()) + 1) + wall.layer
    for key in np.unique(group):
        own = np.flatnonzero(group == key)
        out[own] = np.arange(len(own)) / len(own)
    return out


def _interleaved(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Return the numbers whose bits are those of two others by turns."""
    out = np.zeros_like(one)
    for bit in range(20):
        out |= ((one >> bit) & 1) << (2 * bit + 1) | ((two >> bit) & 1) << (2 * bit)
    return out
