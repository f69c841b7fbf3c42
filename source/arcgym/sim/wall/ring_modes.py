# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Modes in which every ring of the wall moves as a whole, in numpy.

A ring moves by x_i += t + p_i g_p + q_i g_q: any affine motion of its plane. (p, q) are the coordinates that its
vertices have in the ring's plane at rest, over their rms distance from its center; t, g_p, g_q are vectors in space.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from arcgym.sim.wall.wall_topology import members

MODES = 9
"""Unknowns of a ring: t, g_p and g_q."""


@dataclass(frozen=True)
class RingModes:
    """One world's wall in the modes of its rings, for the coarse correction; R rings, V vertices."""

    plane: np.ndarray
    """In-plane coordinates (p, q) of every vertex, shape (V, 2)."""
    members: np.ndarray
    """Vertices of each ring, -1 padded, shape (R, S)."""
    bending: np.ndarray
    """Cholesky factor of each band's bound on bending over flexural rigidity [1/m], see :func:`bending_bound`, shape
    (R, 3, 3); 0 after the last ring."""
    moves: np.ndarray
    """Whether all of a ring's vertices move, shape (R,), bool; the others stay where they are."""
    mass: np.ndarray
    """Sum of mass times the products of (1, p, q) [kg], shape (R, 3, 3)."""
    anchor: np.ndarray
    """The same of the anchor springs [N/m], shape (R, 3, 3)."""


def ring_modes(
    points: np.ndarray,
    ring: np.ndarray,
    mobile: np.ndarray,
    mass: np.ndarray,
    anchor: np.ndarray,
    share: np.ndarray | None = None,
) -> RingModes:
    """Find the rings' planes and project mass and anchors on their modes.

    Args:
        points: Rest positions [m], shape (V, 3).
        ring: Ring of each vertex, shape (V,).
        mobile: Whether each vertex moves, shape (V,), bool.
        mass: Vertex masses [kg], shape (V,).
        anchor: Vertex anchor springs [N/m], shape (V,).
        share: Thickness of each ring over the tissue's, shape (R,); None for 1. A band bends as its thicker ring.
    """
    count = int(ring.max()) + 1
    group = members(np.arange(len(points)), ring, count, pad_first=False)
    points = points.astype(np.float64)
    plane, radius = _in_plane(points, group)
    bending = np.zeros((count, 3, 3))
    bending[:-1] = np.linalg.cholesky(bending_bound(points, plane, radius, group))
    if share is not None:
        bending[:-1] *= (np.maximum(share[:-1], share[1:]) ** 1.5)[:, None, None]
    moves = np.array([mobile[row[row >= 0]].all() for row in group])
    fields = np.column_stack([np.ones(len(points)), plane])
    mass, anchor = (_products(values, ring, fields, count) for values in (mass, anchor))
    return RingModes(plane, group, bending, moves, mass, anchor)


def bending_bound(points: np.ndarray, plane: np.ndarray, radius: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Bound each band's share of the bending along the colon, over flexural rigidity [1/m^2], shape (R - 1, 3, 3).

    With the outward move u of a ring, du from a ring to the next and the distance h between their vertices, bending
    costs D / 2 (du / h - du' / h')^2 / m for a width of the wall, where a band and the one before meet and m is their
    mean length. As (a - b)^2 <= 2 a^2 + 2 b^2, a band has D (du / h)^2 (1 / m + 1 / m') of it and of the next one at
    most. A ring moves outwards by widening, (p.g_p + q.g_q) / 2, and by flattening, (p.g_p - q.g_q) / 2 and
    (q.g_p + p.g_q) / 2, times known numbers at each vertex, and by its translation. By the same inequality, twice the
    former's part and twice the latter's are enough; the latter's is small against the band's shear and left out. The
    bound is the matrix between twice the amplitudes of widening and flattening.

    Args:
        points: Rest positions [m], shape (V, 3).
        plane: In-plane coordinates, shape (V, 2).
        radius: Radius of each ring [m], shape (R,).
        group: Vertices of each ring, -1 padded, shape (R, S).
    """
    rows = [row[row >= 0] for row in group]
    apart = [np.linalg.norm(points[a][:, None] - points[b], axis=2) for a, b in pairwise(rows)]
    length = [distance.min(axis=1) for distance in apart]
    out = np.zeros((len(apart), 3, 3))
    for r, distance in enumerate(apart):
        before = apart[r - 1].min(axis=0) if r > 0 else length[r]
        after = length[r + 1][distance.argmin(axis=1)] if r + 1 < len(apart) else length[r]
        means = 1.0 / (0.5 * (before + length[r])) + 1.0 / (0.5 * (length[r] + after))
        weight = (2.0 * np.pi * radius[r] / len(rows[r])) * means / length[r] ** 2
        p, q = plane[rows[r]].T
        size = np.hypot(p, q)
        moves = np.stack([size, (p * p - q * q) / np.maximum(size, 1e-6), 2.0 * p * q / np.maximum(size, 1e-6)])
        out[r] = (weight * moves) @ moves.T + 1e-6 * weight.sum() * np.eye(3)
    return out


def _in_plane(points: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return in-plane coordinates, shape (V, 2), and the rings' radii; the axes turn as little as they can."""
    plane, radius = np.zeros((len(points), 2)), np.zeros(len(group))
    normal = p = None
    for r, row in enumerate(group):
        row = row[row >= 0]
        local = points[row] - points[row].mean(axis=0)
        axes = np.linalg.svd(local, full_matrices=False)[2]
        across = np.cross(axes[0], axes[1])
        normal = across if normal is None or across @ normal > 0.0 else -across
        p = axes[0] if p is None else p - normal * (normal @ p)
        p = p / np.linalg.norm(p)
        radius[r] = np.sqrt((local**2).sum(axis=1).mean())
        plane[row] = local @ np.column_stack([p, np.cross(normal, p)]) / radius[r]
    return plane, radius


def _products(values: np.ndarray, ring: np.ndarray, fields: np.ndarray, count: int) -> np.ndarray:
    out = np.zeros((count, 3, 3))
    np.add.at(out, ring, np.einsum("v,vk,vn->vkn", values, fields, fields))
    return out


def band_elements(elements: np.ndarray, ring: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sort elements by the band between two rings in which they lie; one within a ring counts to the band before.

    Elements over more than two rings, which only a mesh without rings of its own has, are left out.

    Args:
        elements: Vertices of each element, shape (E, n).
        ring: Ring of each vertex, shape (V,).

    Returns:
        First element of each ring's band, shape (R + 1,), and elements by band, shape (at most E,), both int32.
    """
    lowest, highest = ring[elements].min(axis=1), ring[elements].max(axis=1)
    near = np.flatnonzero(highest <= lowest + 1)
    band = np.maximum(highest[near] - 1, 0)
    order = np.argsort(band, kind="stable")
    start = np.searchsorted(band[order], np.arange(int(ring.max()) + 2))
    return start.astype(np.int32), near[order].astype(np.int32)
