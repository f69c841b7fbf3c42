# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest geometry of a shell's triangles and hinges, in numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BENDING_WEIGHT = 0.36
"""Share c in the hinge stiffness c D 3 L^2 / (A1 + A2) (weights of Grinspun et al. 2003). A grid of right-angled
triangles bends about its edges with 1/3; the twist it lacks is made up for by a little more, chosen by the row
``wall_ring`` of ``arcgym bench fidelity``."""


@dataclass(frozen=True)
class ShellGeometry:
    """Rest geometry of a shell's F triangles and H hinges."""

    triangles: np.ndarray
    """Vertices, shape (F, 3)."""
    inv_rest: np.ndarray
    """Inverse edge matrix in the triangle's own plane [1/m], shape (F, 2, 2)."""
    area: np.ndarray
    """[m^2], shape (F,)."""
    hinges: np.ndarray
    """Two opposite vertices, then start and end of the edge, shape (H, 4)."""
    sides: np.ndarray
    """Triangles of the two opposite vertices, shape (H, 2)."""
    foot: np.ndarray
    """Where along the edge the opposite vertices stand, from 0 at its start to 1 at its end, shape (H, 2)."""
    length: np.ndarray
    """Length of the edge [m], shape (H,)."""
    rest_angle: np.ndarray
    """Dihedral angle [rad], shape (H,)."""
    weight: np.ndarray
    """Hinge stiffness over flexural rigidity, c 3 L^2 / (A1 + A2), shape (H,)."""


def shell_geometry(points: np.ndarray, triangles: np.ndarray) -> ShellGeometry:
    """Rest geometry of the triangles and of the edges between two of them."""
    points = points.astype(np.float64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    along = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    area = 0.5 * np.linalg.norm(normal, axis=1)
    across = np.cross(normal / (2.0 * area[:, None]), along)
    edges = np.stack([np.stack([(d * along).sum(1), (d * across).sum(1)], 1) for d in (b - a, c - a)], axis=2)
    hinges, sides = _hinges(triangles)
    edge = points[hinges[:, 3]] - points[hinges[:, 2]]
    length = np.linalg.norm(edge, axis=1)
    opposite = points[hinges[:, :2]] - points[hinges[:, 2:3]]
    foot = np.einsum("hki,hi->hk", opposite, edge) / length[:, None] ** 2
    weight = BENDING_WEIGHT * 3.0 * length**2 / area[sides].sum(axis=1)
    angle = fold_angles(points, hinges)
    return ShellGeometry(triangles, np.linalg.inv(edges), area, hinges, sides, foot, length, angle, weight)


def _hinges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner edges as (opposite, opposite, start, end) with the triangles on both sides."""
    corner = np.arange(3)
    start, end = triangles[:, (corner + 1) % 3].ravel(), triangles[:, (corner + 2) % 3].ravel()
    opposite, owner = triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)
    key = np.minimum(start, end).astype(np.int64) * (int(triangles.max()) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    one, two = order[same], order[same + 1]
    hinges = np.stack([opposite[one], opposite[two], start[one], end[one]], axis=1)
    return hinges.astype(np.int32), np.stack([owner[one], owner[two]], axis=1)


def fold_angles(points: np.ndarray, hinges: np.ndarray) -> np.ndarray:
    """Dihedral angle of each hinge [rad], zero where its triangles are coplanar, shape (H,)."""
    x0, x1, x2, x3 = (points[hinges[:, k]] for k in range(4))
    edge = (x3 - x2) / np.linalg.norm(x3 - x2, axis=1, keepdims=True)
    n0, n1 = np.cross(x2 - x0, x3 - x0), np.cross(x3 - x1, x2 - x1)
    return np.arctan2((np.cross(n0, n1) * edge).sum(1), (n0 * n1).sum(1))


def fold_gradients(points: np.ndarray, hinges: np.ndarray) -> np.ndarray:
    """Return the derivative of each hinge's angle with respect to its vertices [rad/m], shape (H, 4, 3)."""
    x0, x1, x2, x3 = (points[hinges[:, k]].astype(np.float64) for k in range(4))
    edge = x3 - x2
    squared = (edge**2).sum(1, keepdims=True)
    n0, n1 = np.cross(x2 - x0, x3 - x0), np.cross(x3 - x1, x2 - x1)
    g0 = -np.sqrt(squared) * n0 / (n0**2).sum(1, keepdims=True)
    g1 = -np.sqrt(squared) * n1 / (n1**2).sum(1, keepdims=True)
    t0, t1 = ((x0 - x2) * edge).sum(1, keepdims=True) / squared, ((x1 - x2) * edge).sum(1, keepdims=True) / squared
    return np.stack([g0, g1, (t0 - 1.0) * g0 + (t1 - 1.0) * g1, -t0 * g0 - t1 * g1], axis=1)
