# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Triangles, normals, skin weights and texture coordinates of a visual surface on a grid of rows and columns."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from arcgym.anatomy.measures import face_normals
from arcgym.anatomy.mucosa.vessel_styles import texture_rows
from arcgym.anatomy.stage.types import TEXTURE_LENGTH

_TWIST = 0.55
"""Length of colon over which the texture turns once round the lumen [m]; our choice."""

_DOME_ROW = 0.875
"""Row of the texture at the cecal pole, as a share of its height: the middle of the cecum's band."""


def grid_triangles(rows: int, columns: int) -> np.ndarray:
    """Return the triangles of an open grid (rows along, columns around), facing the lumen, shape (F, 3), int32."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a, b = i * columns + j, (i + 1) * columns + j
    c, d = b + 1, a + 1
    even = ((i + j) % 2 == 0)[..., None]
    first = np.where(even, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)]).astype(np.int32)


def smooth_normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return area-weighted vertex normals, continuous over the texture seam, shape (M, 3), float32.

    Vertices at the same place (to 1 um) share one normal.
    """
    _, place = np.unique(np.round(points * 1e6).astype(np.int64), axis=0, return_inverse=True)
    place = place.ravel()
    area = face_normals(points, faces)
    corner, weight = place[faces.T.ravel()], np.tile(area, (3, 1))
    sums = np.stack([np.bincount(corner, weight[:, k], place.max() + 1) for k in range(3)], 1)
    normals = sums[place]
    return (normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)).astype(np.float32)


def skin_to_rings(
    s: np.ndarray, theta: np.ndarray, ring_arc: np.ndarray, sectors: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return bilinear weights of surface points on the wall's inner grid.

    Args:
        s: Arc length of each point [m], shape (M,).
        theta: Angle around the lumen [rad], shape (M,); sector j of the wall stands at ``2 pi j / sectors``.
        ring_arc: Arc length of the wall's rings [m], shape (R,).
        sectors: Wall vertices around a ring.

    Returns:
        Wall vertex indices, shape (M, 4), int32, and weights that sum to 1, shape (M, 4), float32.
    """
    rows = np.interp(s, ring_arc, np.arange(len(ring_arc)))
    row = np.minimum(np.floor(rows).astype(int), len(ring_arc) - 2)
    along = rows - row
    columns = np.mod(theta, 2 * np.pi) * sectors / (2 * np.pi)
    column = np.floor(columns).astype(int)
    around = columns - column
    column, after = column % sectors, (column + 1) % sectors
    corners = [row * sectors + column, (row + 1) * sectors + column, (row + 1) * sectors + after, row * sectors + after]
    weights = [(1 - along) * (1 - around), along * (1 - around), along * around, (1 - along) * around]
    return np.stack(corners, 1).astype(np.int32), np.stack(weights, 1).astype(np.float32)


def tube_texture(s: np.ndarray, theta: np.ndarray, bounds: Mapping[str, tuple[float, float]]) -> np.ndarray:
    """Return u round the lumen and v along it, in the band that shows the segment's vessels, shape (n, 2).

    u turns slowly with the arc length, so that no two passes over a band of the texture look the same.

    Args:
        s: Arc lengths [m], shape (n,).
        theta: Angles round the lumen [rad], shape (n,).
        bounds: Arc length where each segment starts and ends [m].
    """
    return np.stack([theta / (2 * np.pi) + s / _TWIST, texture_rows(s, bounds, TEXTURE_LENGTH)], 1)


def dome_texture(meridian: np.ndarray, theta: np.ndarray, rim: float) -> np.ndarray:
    """Return u and v on the dome of the cecum, equal distances from the pole in every direction, shape (n, 2).

    A polar chart would squeeze the texture into streaks at the pole.

    Args:
        meridian: Distance from the pole along the wall [m], shape (n,).
        theta: Angles round the lumen [rad], shape (n,).
        rim: Radius of the lumen where the dome begins [m].
    """
    u = 0.5 + meridian * np.cos(theta) / (2 * np.pi * rim)
    return np.stack([u, _DOME_ROW + meridian * np.sin(theta) / TEXTURE_LENGTH], 1)
