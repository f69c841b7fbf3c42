# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Affine ring modes of the wall and its rest stiffness in them, in numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.sim.wall_topology import members

MODES = 9
"""Unknowns of a ring: index 3 * axis + mode, with the modes (1, p, q)."""


@dataclass(frozen=True)
class RingModes:
    """What the coarse correction needs of one world's wall; R rings, V vertices."""

    weights: np.ndarray
    """(1, p, q) of every vertex: in-plane coordinates over the ring's rms radius, shape (V, 3)."""
    members: np.ndarray
    """Vertices of each ring, -1 padded, shape (R, S)."""
    rest_frame: np.ndarray
    """Ring frames at rest, columns p, q, p x q, shape (R, 3, 3)."""
    stiffness: np.ndarray
    """Diagonal blocks [N/m], shape (R, 9, 9)."""
    coupling: np.ndarray
    """Blocks from each ring to the next [N/m], shape (R, 9, 9)."""
    mass: np.ndarray
    """[kg], shape (R, 9, 9)."""
    anchor: np.ndarray
    """[N/m], shape (R, 9, 9)."""


def ring_modes(
    points: np.ndarray,
    tets: np.ndarray,
    ring: np.ndarray,
    mobile: np.ndarray,
    mass: np.ndarray,
    anchor: np.ndarray,
    lame: np.ndarray,
) -> RingModes:
    """Project rest stiffness, mass and anchors on the affine ring modes.

    Args:
        points: Rest positions [m], shape (V, 3).
        tets: Vertex indices, shape (T, 4).
        ring: Ring of each vertex, shape (V,).
        mobile: Whether each vertex moves, shape (V,), bool.
        mass: Vertex masses [kg], shape (V,).
        anchor: Vertex anchor springs [N/m], shape (V,).
        lame: Lamé parameters (mu, lambda) [Pa], shape (T, 2).
    """
    count = int(ring.max()) + 1
    group = members(np.arange(len(points)), ring, count, pad_first=False)
    weights, frames = _affine_weights(points, group)
    moving = weights * mobile[:, None]
    stiffness, coupling = _stiffness_blocks(points, tets, ring, moving, lame, count)
    held = ~np.array([mobile[g[g >= 0]].any() for g in group])
    stiffness[held] += 1.0e3 * np.eye(MODES)
    return RingModes(
        weights,
        group,
        frames,
        stiffness,
        coupling,
        _lumped_blocks(mass, ring, moving, count),
        _lumped_blocks(anchor, ring, moving, count),
    )


def _affine_weights(points: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    weights = np.zeros((len(points), 3))
    frames = np.zeros((len(group), 3, 3))
    for r, row in enumerate(group):
        row = row[row >= 0]
        local = points[row] - points[row].mean(axis=0)
        axes = np.linalg.svd(local, full_matrices=False)[2]
        plane = local @ axes[:2].T / np.sqrt((local**2).sum(axis=1).mean())
        weights[row] = np.column_stack([np.ones(len(row)), plane])
        p = plane[:, 0] @ points[row]
        q = plane[:, 1] @ points[row]
        p /= np.linalg.norm(p)
        q -= p * (p @ q)
        q /= np.linalg.norm(q)
        frames[r] = np.column_stack([p, q, np.cross(p, q)])
    return weights, frames


def element_stiffness(points: np.ndarray, tets: np.ndarray, lame: np.ndarray) -> np.ndarray:
    """Small-strain stiffness of linear tets, shape (T, 4, 3, 4, 3) [N/m].

    K_aibj = V (mu (g_a.g_b d_ij + g_aj g_bi) + lambda g_ai g_bj), g the shape gradients
    (Hughes, The Finite Element Method, section 2.7). It is the stable neo-Hookean Hessian at rest.
    """
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    inverse = np.linalg.inv(edges)
    gradient = np.concatenate([-inverse.sum(axis=2)[:, None], inverse.transpose(0, 2, 1)], axis=1)
    volume = np.abs(np.linalg.det(edges)) / 6.0
    mu, lam = lame[:, 0], lame[:, 1]
    out = np.einsum("t,tak,tbk,ij->taibj", mu, gradient, gradient, np.eye(3))
    out += np.einsum("t,taj,tbi->taibj", mu, gradient, gradient)
    out += np.einsum("t,tai,tbj->taibj", lam, gradient, gradient)
    return volume[:, None, None, None, None] * out


def _stiffness_blocks(
    points: np.ndarray, tets: np.ndarray, ring: np.ndarray, weights: np.ndarray, lame: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    corner_ring = ring[tets]
    if (np.ptp(corner_ring, axis=1) > 1).any():
        bad = int(np.argmax(np.ptp(corner_ring, axis=1)))
        raise ValueError(
            f"Wall tet {bad} spans rings {sorted(set(corner_ring[bad]))}; tets may join adjacent rings only."
        )
    w = weights[tets]
    blocks = np.einsum("taibj,tam,tbn->tabimjn", element_stiffness(points, tets, lame), w, w)
    blocks = blocks.reshape(len(tets), 4, 4, MODES, MODES)
    diagonal = np.zeros((count, MODES, MODES))
    upper = np.zeros((count, MODES, MODES))
    for a in range(4):
        for b in range(4):
            step = corner_ring[:, b] - corner_ring[:, a]
            np.add.at(diagonal, corner_ring[step == 0, a], blocks[step == 0, a, b])
            np.add.at(upper, corner_ring[step == 1, a], blocks[step == 1, a, b])
    return diagonal, upper


def _lumped_blocks(values: np.ndarray, ring: np.ndarray, weights: np.ndarray, count: int) -> np.ndarray:
    out = np.zeros((count, MODES, MODES))
    outer = values[:, None, None] * weights[:, :, None] * weights[:, None, :]
    for axis in range(3):
        part = slice(3 * axis, 3 * axis + 3)
        np.add.at(out[:, part, part], ring, outer)
    return out
