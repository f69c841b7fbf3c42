# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Modes in which every ring of the wall moves as a whole, and the wall's rest stiffness in them, in numpy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arcgym.sim.wall.wall_topology import members

MODES = 9
"""Unknowns of a ring."""
PARTS = 3
"""Parts of the elastic energy that scale on their own: shear, second Lamé parameter, bending."""


@dataclass(frozen=True)
class RingModes:
    """One world's wall in the modes of its rings, for the coarse correction; R rings, V vertices, M modes."""

    basis: np.ndarray
    """Displacement of every vertex in each mode at rest, shape (V, M, 3)."""
    frame_weights: np.ndarray
    """In-plane coordinates (p, q) of every vertex over the ring's rms radius, shape (V, 2)."""
    members: np.ndarray
    """Vertices of each ring, -1 padded, shape (R, S)."""
    rest_frame: np.ndarray
    """Ring frames at rest, columns p, q, p x q, shape (R, 3, 3)."""
    stiffness: np.ndarray
    """Diagonal blocks of each part [N/m], shape (P, R, M, M)."""
    coupling: np.ndarray
    """Blocks of each part from each ring to the next [N/m], shape (P, R, M, M)."""
    mass: np.ndarray
    """[kg], shape (R, M, M)."""
    anchor: np.ndarray
    """[N/m], shape (R, M, M)."""


@dataclass(frozen=True)
class ElasticPart:
    """Small-strain stiffness of elements, all of one part of the energy."""

    vertices: np.ndarray
    """Vertices of each element, shape (E, n)."""
    stiffness: np.ndarray
    """Stiffness [N/m], shape (E, n, 3, n, 3)."""

    @staticmethod
    def none() -> ElasticPart:
        """Return a part without elements."""
        return ElasticPart(np.zeros((0, 1), np.int32), np.zeros((0, 1, 3, 1, 3)))


def ring_modes(
    points: np.ndarray,
    ring: np.ndarray,
    mobile: np.ndarray,
    mass: np.ndarray,
    anchor: np.ndarray,
    parts: Sequence[ElasticPart],
) -> RingModes:
    """Project rest stiffness, mass and anchors on the modes of the rings.

    Args:
        points: Rest positions [m], shape (V, 3).
        ring: Ring of each vertex, shape (V,).
        mobile: Whether each vertex moves, shape (V,), bool.
        mass: Vertex masses [kg], shape (V,).
        anchor: Vertex anchor springs [N/m], shape (V,).
        parts: Elements of each of the ``PARTS`` parts; an element over three rings, as a hinge about an edge within a
            ring, is left out: it resists bending along the colon, which hardly counts beside stretching.
    """
    count = int(ring.max()) + 1
    group = members(np.arange(len(points)), ring, count, pad_first=False)
    basis, plane, frames = _ring_basis(points.astype(np.float64), group)
    basis = basis * mobile[:, None, None]
    blocks = [_stiffness_blocks(part, ring, basis, count) for part in parts]
    stiffness, coupling = np.stack([b[0] for b in blocks]), np.stack([b[1] for b in blocks])
    held = ~np.array([mobile[g[g >= 0]].any() for g in group])
    stiffness[0, held] += 1.0e3 * np.eye(MODES)
    return RingModes(
        basis,
        plane,
        group,
        frames,
        stiffness,
        coupling,
        _lumped_blocks(mass, ring, basis, count),
        _lumped_blocks(anchor, ring, basis, count),
    )


def _ring_basis(points: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    basis, plane = np.zeros((len(points), MODES, 3)), np.zeros((len(points), 2))
    frames = np.zeros((len(group), 3, 3))
    for r, row in enumerate(group):
        row = row[row >= 0]
        local = points[row] - points[row].mean(axis=0)
        axes = np.linalg.svd(local, full_matrices=False)[2]
        size = np.sqrt((local**2).sum(axis=1).mean())
        plane[row] = local @ axes[:2].T / size
        basis[row] = _ring_displacements(plane[row], axes[0], axes[1])
        p, q = plane[row, 0] @ points[row], plane[row, 1] @ points[row]
        p /= np.linalg.norm(p)
        q -= p * (p @ q)
        q /= np.linalg.norm(q)
        frames[r] = np.column_stack([p, q, np.cross(p, q)])
    return basis, plane, frames


def _ring_displacements(plane: np.ndarray, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return affine displacements: three translations, two tilts, twist, dilation, two flattenings, shape (n, M, 3).

    Flattening affinely stretches the ring, which a shell would avoid; modes that do avoid it at rest are far softer
    than the wall once it is dented, and the correction then overshoots without bound.
    """
    angle = np.arctan2(plane[:, 1], plane[:, 0])
    radial = np.cos(angle)[:, None] * p + np.sin(angle)[:, None] * q
    along = -np.sin(angle)[:, None] * p + np.cos(angle)[:, None] * q
    size = np.linalg.norm(plane, axis=1)[:, None]
    double = 2.0 * angle
    out = np.zeros((len(plane), MODES, 3))
    out[:, :3] = np.eye(3)
    out[:, 3], out[:, 4] = plane[:, :1] * np.cross(p, q), plane[:, 1:] * np.cross(p, q)
    out[:, 5], out[:, 6] = size * along, size * radial
    out[:, 7] = size * (np.cos(double)[:, None] * radial - np.sin(double)[:, None] * along)
    out[:, 8] = size * (np.sin(double)[:, None] * radial + np.cos(double)[:, None] * along)
    return out


def _stiffness_blocks(
    part: ElasticPart, ring: np.ndarray, basis: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    corner_ring = ring[part.vertices]
    near = np.ptp(corner_ring, axis=1) <= 1
    vertices, corner_ring = part.vertices[near], corner_ring[near]
    modes = basis[vertices]
    blocks = np.einsum("tami,taibj,tbnj->tabmn", modes, part.stiffness[near], modes, optimize=True)
    diagonal = np.zeros((count, MODES, MODES))
    upper = np.zeros((count, MODES, MODES))
    corners = vertices.shape[1]
    for a in range(corners):
        for b in range(corners):
            step = corner_ring[:, b] - corner_ring[:, a]
            np.add.at(diagonal, corner_ring[step == 0, a], blocks[step == 0, a, b])
            np.add.at(upper, corner_ring[step == 1, a], blocks[step == 1, a, b])
    return diagonal, upper


def _lumped_blocks(values: np.ndarray, ring: np.ndarray, basis: np.ndarray, count: int) -> np.ndarray:
    out = np.zeros((count, MODES, MODES))
    np.add.at(out, ring, np.einsum("v,vmi,vni->vmn", values, basis, basis))
    return out
