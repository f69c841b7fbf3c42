# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Cells of a wall's grid, each of two triangles, and how their strains compare, in numpy."""

from __future__ import annotations

import numpy as np

from arcgym.assets.shell_geometry import ShellGeometry


def cell_partners(geometry: ShellGeometry, ring: np.ndarray) -> np.ndarray:
    """Return the other triangle of each one's cell, or the triangle itself where it has none, shape (F,), int32.

    The triangles between two rings follow each other around, each across an edge from ring to ring: a cell's diagonal,
    or a side of two cells. Of the two ways to pair them that whose shared edges are longer in all takes the diagonals.

    Args:
        geometry: Rest geometry of the wall.
        ring: Ring of each vertex, shape (V,).
    """
    own = ring[geometry.triangles]
    banded = np.ptp(own, axis=1) == 1
    crossing = ring[geometry.hinges[:, 2]] != ring[geometry.hinges[:, 3]]
    edges = np.flatnonzero(crossing & banded[geometry.sides].all(axis=1))
    doors: list[list[int]] = [[] for _ in geometry.triangles]
    for hinge in edges:
        for triangle in geometry.sides[hinge]:
            doors[triangle].append(int(hinge))
    partner = np.arange(len(doors), dtype=np.int32)
    seen = np.zeros(len(doors), bool)
    for first in range(len(doors)):
        around = _walk(first, doors, geometry.sides, seen)
        ways = [around[k::2] for k in range(2)]
        if len(around) < 2 or len(ways[0]) != len(ways[1]):
            continue
        pairs = geometry.sides[max(ways, key=lambda way: float(geometry.length[way].sum()))]
        partner[pairs[:, 0]], partner[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
    return partner


def _walk(first: int, doors: list[list[int]], sides: np.ndarray, seen: np.ndarray) -> list[int]:
    """Return the edges crossed from a triangle around the band back to it; none if it was seen or the band is open."""
    crossed: list[int] = []
    at = first
    while not seen[at] and len(doors[at]) == 2:
        seen[at] = True
        hinge = doors[at][1] if crossed and doors[at][0] == crossed[-1] else doors[at][0]
        crossed.append(hinge)
        at = int(sides[hinge].sum()) - at
    return crossed if crossed and at == first else []


def partner_edges(geometry: ShellGeometry, points: np.ndarray, partner: np.ndarray) -> np.ndarray:
    """Return what a triangle's edges are in the strain of its partner, shape (F, 3, 3).

    With the partner's metric C, unfolded into the triangle's plane about the edge they share, the squared length of
    the triangle's edge e is e^T C e, and C is linear in the squared lengths of the partner's own edges. The rows are
    the edges opposite to the triangle's corners, the columns those opposite to the partner's.

    Args:
        geometry: Rest geometry of the wall.
        points: Rest positions [m], shape (V, 3).
        partner: See :func:`cell_partners`.
    """
    out = np.tile(np.eye(3), (len(partner), 1, 1))
    paired = np.flatnonzero(partner != np.arange(len(partner)))
    mine, other = geometry.triangles[paired], geometry.triangles[partner[paired]]
    shared = (mine[:, :, None] == other[:, None, :]).any(axis=2)
    start = mine[np.arange(len(mine)), (shared & ~np.roll(shared, 1, axis=1)).argmax(axis=1)]
    end = mine[np.arange(len(mine)), (shared & ~np.roll(shared, -1, axis=1)).argmax(axis=1)]
    axes = points[start].astype(float), points[end].astype(float)
    forms = [_squares(points.astype(float), corners, *axes, side) for corners, side in ((mine, -1.0), (other, 1.0))]
    out[paired] = forms[0] @ np.linalg.inv(forms[1])
    return out


def _squares(points: np.ndarray, corners: np.ndarray, start: np.ndarray, end: np.ndarray, side: float) -> np.ndarray:
    """Return the squared length of each edge by the entries (11, 22, 12) of a metric in the plane, shape (n, 3, 3)."""
    along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
    away = points[corners] - start[:, None]
    u = np.einsum("nci,ni->nc", away, along)
    v = side * np.linalg.norm(away - u[:, :, None] * along[:, None], axis=2)
    flat = np.stack([u, v], axis=2)
    edge = np.roll(flat, -2, axis=1) - np.roll(flat, -1, axis=1)
    return np.stack([edge[..., 0] ** 2, edge[..., 1] ** 2, 2.0 * edge[..., 0] * edge[..., 1]], axis=2)
