# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tetrahedral wall on a grid of rings and sectors, one layer thick, closed at the blind end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from arcgym.anatomy.segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS
from arcgym.anatomy.stage.types import WallMesh

if TYPE_CHECKING:
    from arcgym.anatomy.curve import Curve

LAST_RING_GAP = 0.003
"""Distance of the last ring from the cecal pole [m]: it stands short of the pole, where the dome is wide."""

FIXED_RINGS_START = 3
"""Rings held still at the anus, where the pelvic floor surrounds the canal."""

FIXED_RINGS_END = 2
"""Rings held still at the blind end, so that the simulated piece is held at both ends."""

_PRISM = ((0, 1, 2, 5), (0, 1, 4, 5), (0, 3, 4, 5))
"""Corners of the three tetrahedra of a prism: its inner triangle, then its outer one."""

_MIRRORED = (False, True, False)
"""Which of them have negative volume in a prism whose triangles wind outwards in that order."""


def ring_arcs(length: float, spacing: float) -> np.ndarray:
    """Return the arc length of each ring [m], evenly spaced by about ``spacing`` from 0 to short of the pole."""
    end = length - LAST_RING_GAP
    return np.linspace(0.0, end, round(end / spacing) + 1)


def wall_layers(curve: Curve, ring_arc: np.ndarray, radius: np.ndarray, thickness: float) -> np.ndarray:
    """Return the positions of the wall's two layers, for :func:`build_wall`.

    Args:
        curve: Centerline.
        ring_arc: Arc length of the rings [m], shape (R,).
        radius: Distance of the inner layer from the centerline [m], shape (R, S).
        thickness: Distance of the layers [m]; the last two rings' outer layer also goes on along the centerline.

    Returns:
        Positions of layer, ring and sector [m], shape (2, R, S, 3), the lumen side first.
    """
    theta = np.arange(radius.shape[1]) * 2 * np.pi / radius.shape[1]
    center, outwards = curve.position(ring_arc)[:, None], curve.outwards(ring_arc[:, None], theta)
    outer = center + (radius + thickness)[..., None] * outwards
    tangent, _, _ = curve.frame(ring_arc[-2:])
    outer[-2:] += thickness * np.array([0.5, 1.0])[:, None, None] * tangent[:, None]
    return np.stack([center + radius[..., None] * outwards, outer])


def build_wall(layers: np.ndarray, ring_segment: np.ndarray, ring_arc: np.ndarray, capped: bool = True) -> WallMesh:
    """Build the wall from the rest positions of its vertex layers.

    Args:
        layers: Positions of layer, ring and sector [m], shape (2, R, S, 3), the lumen side first. Sectors run
            right-handed about the direction of the rings; otherwise all elements are inverted.
        ring_segment: Segment index of each ring, shape (R,).
        ring_arc: Arc length of each ring [m], shape (R,).
        capped: Closes the last ring with a wall.
    """
    count, rings, sectors, _ = layers.shape
    points = layers.reshape(-1, 3).astype(np.float32)
    triangles = tube_triangles(rings, sectors)[:, ::-1]
    if capped:
        triangles = np.concatenate([triangles, (rings - 1) * sectors + polygon_triangles(sectors)])
    layer = np.repeat(np.arange(count, dtype=np.int32), rings * sectors)
    ring = np.tile(np.repeat(np.arange(rings, dtype=np.int32), sectors), count)
    segment = np.asarray(ring_segment, np.int32)[ring]
    return WallMesh(
        points=points,
        tets=_extrude(triangles, rings * sectors),
        anchor=_anchors(ring, layer, segment, rings),
        segment=segment,
        ring=ring,
        layer=layer,
        frame_neighbors=_frame_neighbors(count, rings, sectors),
        ring_arc=np.asarray(ring_arc, np.float32),
    )


def tube_triangles(rings: int, sectors: int) -> np.ndarray:
    """Return the triangles of a tube of ``rings`` closed rings, shape (F, 3), int32.

    All diagonals run the same way around: then the bending of triangles is exact for every constant curvature, and
    twist is not four times too stiff as with diagonals that alternate (:mod:`arcgym.assets.shell_geometry`).
    """
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(sectors), indexing="ij")
    after = (j + 1) % sectors
    a, b, c, d = i * sectors + j, (i + 1) * sectors + j, (i + 1) * sectors + after, i * sectors + after
    halves = [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    return np.concatenate([half.reshape(-1, 3) for half in halves]).astype(np.int32)


def polygon_triangles(sectors: int) -> np.ndarray:
    """Return a triangulation of a ring by a zigzag across it, shape (sectors - 2, 3), int32."""
    low, high, triangles = 0, sectors - 1, []
    while high - low > 1:
        triangles.append((low, low + 1, high))
        if high - low > 2:
            triangles.append((low + 1, high - 1, high))
        low, high = low + 1, high - 1
    return np.array(triangles, np.int32)


def _extrude(triangles: np.ndarray, stride: int) -> np.ndarray:
    """Split each prism between a triangle and its copy one layer out into three tetrahedra.

    Prisms are split by ascending vertex number, so that neighbors agree on the diagonal of the face they share. Where
    the layers do not cross each other, volumes are positive: the order of vertices follows from the winding of the
    triangles, whose normals point to the outer layer, and is the same in all walls of a grid.
    """
    low = np.sort(triangles, 1)
    chain = [low[:, 0], low[:, 1], low[:, 2], *(low[:, k] + stride for k in range(3))]
    tets = np.stack([np.stack([chain[k] for k in corners], 1) for corners in _PRISM], 1)
    even = np.any([(np.roll(low, k, 1) == triangles).all(1) for k in range(3)], axis=0)
    mirrored = ~even[:, None] ^ np.array(_MIRRORED)
    tets[mirrored] = tets[mirrored][:, [1, 0, 2, 3]]
    return tets.reshape(-1, 4).astype(np.int32)


def _anchors(ring: np.ndarray, layer: np.ndarray, segment: np.ndarray, rings: int) -> np.ndarray:
    """Fix the ends and tie the outer side of the retroperitoneal segments."""
    tied = np.isin(segment, [SEGMENTS.index(name) for name in RETROPERITONEAL]) & (layer == layer.max())
    anchor = np.where(tied, ANCHOR_ELASTIC, ANCHOR_FREE)
    ends = (ring < FIXED_RINGS_START) | (ring >= rings - FIXED_RINGS_END)
    return np.where(ends, ANCHOR_FIXED, anchor).astype(np.int32)


def _frame_neighbors(layers: int, rings: int, sectors: int) -> np.ndarray:
    """Return next ring, previous ring, next around and previous around of each vertex, shape (V, 4)."""
    index = np.arange(layers * rings * sectors, dtype=np.int32).reshape(layers, rings, sectors)
    forward = np.concatenate([index[:, 1:], index[:, -1:]], 1)
    back = np.concatenate([index[:, :1], index[:, :-1]], 1)
    neighbors = [forward, back, np.roll(index, -1, 2), np.roll(index, 1, 2)]
    return np.stack([x.ravel() for x in neighbors], 1)
