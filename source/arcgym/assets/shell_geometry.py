# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest geometry of a shell's triangles and hinges, in numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


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
    coupled: np.ndarray
    """Each hinge, then the other two of either of its triangles, or itself where they have none there, shape (H, 5)."""
    coupling: np.ndarray
    """Derivative of each hinge's moment by the angles of its ``coupled``, over flexural rigidity: the part that 1 - nu
    scales and the part that nu scales, shape (H, 5, 2). See :func:`bending_coupling`."""
    bound: np.ndarray
    """Largest stiffness of each hinge over flexural rigidity that any pattern of angles can ask for, shape (H,)."""


def shell_geometry(points: np.ndarray, triangles: np.ndarray, share: np.ndarray | None = None) -> ShellGeometry:
    """Rest geometry of the triangles and of the edges between two of them.

    Args:
        points: Rest positions [m], shape (V, 3).
        triangles: Vertices, shape (F, 3).
        share: Thickness at each vertex over that of the tissue, shape (V,), whose cube is a factor on the stiffness of
            hinges; None for 1.
    """
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
    angle = fold_angles(points, hinges)
    own = hinge_of_edges(triangles, hinges, sides)
    factor = polygon_factor(angle)
    if share is not None:
        factor = factor * share[hinges].mean(axis=1) ** 3
    coupled, coupling = bending_coupling(points, triangles, area, own, factor)
    bound = np.abs(coupling).mean(axis=2).sum(axis=1)  # nu is at most 1/2
    return ShellGeometry(
        triangles, np.linalg.inv(edges), area, hinges, sides, foot, length, angle, coupled, coupling, bound
    )


def polygon_factor(angle: np.ndarray) -> np.ndarray:
    """Factor on the stiffness of hinges with a dihedral angle at rest that lets a ring ovalise as a circle would.

    A regular polygon of N rigid bars whose hinges stand at 2 d = 2 pi / N turns them less when it ovalises (n = 2,
    without stretching) than a circle of the same radius bends: by r = (3 - 4 sin^2 d) / (3 cos d), from the kinematics
    of the bars. Its energy is that of the circle times r^2 sin d / d; with twelve bars 0.88. Own derivation.

    Args:
        angle: Dihedral angle at rest [rad], shape (H,).

    Returns:
        d / (r^2 sin d), shape (H,); at least 1, and constant beyond 60 degrees, a hexagon.
    """
    d = np.clip(0.5 * np.abs(angle), 1.0e-4, np.pi / 6.0)
    return d / np.sin(d) * (3.0 * np.cos(d) / (3.0 - 4.0 * np.sin(d) ** 2)) ** 2


def bending_coupling(
    points: np.ndarray, triangles: np.ndarray, area: np.ndarray, own: np.ndarray, factor: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Bending energy of a Kirchhoff shell as a quadratic form of the hinges' angles.

    The shape operator of a triangle is that of its three hinges, S = sum_i a_i / (2 A l_i) t_i t_i^T, with the angle
    a_i from rest, the length l_i and the edge t_i turned by a right angle in its plane (Gingold et al. 2004, "A
    discrete model for inelastic deformation of thin shells"; Grinspun et al. 2006, "Computing discrete shape operators
    on general meshes"). Its energy is D A / 2 ((1 - nu) S:S + nu (tr S)^2). On a grid whose diagonals all run the same
    way it is that of the plate for every constant curvature.

    Args:
        points: Rest positions [m], shape (V, 3).
        triangles: Vertices, shape (F, 3).
        area: [m^2], shape (F,).
        own: Hinge opposite to each corner, or -1, shape (F, 3).
        factor: Factor on the stiffness of each hinge, shape (H,).

    Returns:
        ``coupled`` and ``coupling`` of :class:`ShellGeometry`.
    """
    corners = points[triangles]
    edge = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    length = np.linalg.norm(edge, axis=2)
    both = length[:, :, None] * length[:, None, :]
    product = np.einsum("fai,fbi->fab", edge, edge)
    parts = np.stack([product**2 / both, both], axis=3) / (4.0 * area[:, None, None, None])
    root = np.where(own >= 0, np.sqrt(factor)[own], 0.0)
    parts *= (root[:, :, None] * root[:, None, :])[..., None]
    count = len(factor)
    coupled = np.repeat(np.arange(count)[:, None], 5, axis=1)
    coupling = np.zeros((count, 5, 2))
    place = np.ones(count, int)
    for corner in range(3):
        hinge = own[:, corner]
        inner = np.flatnonzero(hinge >= 0)
        hinge = hinge[inner]
        np.add.at(coupling[:, 0], hinge, parts[inner, corner, corner])
        # A hinge meets its first triangle and its second in different corners of this loop, or in order within one.
        order = np.argsort(hinge, kind="stable")
        hinge, inner = hinge[order], inner[order]
        again = np.r_[False, hinge[1:] == hinge[:-1]]
        for step in (1, 2):
            other = (corner + step) % 3
            slot = place[hinge] + 2 * again + step - 1
            partner = own[inner, other]
            coupled[hinge, slot] = np.where(partner >= 0, partner, hinge)
            coupling[hinge, slot] = parts[inner, corner, other]
        np.add.at(place, hinge, 2)
    return coupled, coupling


def hinge_of_edges(triangles: np.ndarray, hinges: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Hinge at the edge opposite to each corner of each triangle, -1 at a border, shape (F, 3)."""
    out = np.full(triangles.shape, -1, np.int32)
    for side in range(2):
        triangle = sides[:, side]
        corner = triangles[triangle] == hinges[:, side : side + 1]
        out[triangle, corner.argmax(axis=1)] = np.arange(len(hinges))
    return out


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
