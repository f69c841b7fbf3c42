# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small-strain stiffness of a shell's triangles and hinges and of tets, in numpy, to compare kernels with."""

from __future__ import annotations

import numpy as np

from arcgym.assets.shell_geometry import ShellGeometry


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


def stretching_stiffness(points: np.ndarray, geometry: ShellGeometry) -> tuple[np.ndarray, np.ndarray]:
    """Return the rest stiffness of the triangles for unit shear and unit second Lamé parameter [N/m per N/m].

    K_ab = A (mu (g_b g_a^T + m_a.m_b F F^T) + lambda g_a g_b^T), with the shape gradients m and g = F m.

    Returns:
        The two parts, each by triangle, corner, axis, corner and axis, shape (F, 3, 3, 3, 3).
    """
    x = points.astype(np.float64)[geometry.triangles]
    frame = np.einsum("tki,tkc->tic", x[:, 1:] - x[:, :1], geometry.inv_rest)
    inner = geometry.inv_rest
    m = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    g = np.einsum("tic,tac->tai", frame, m)
    plane = np.einsum("tic,tjc->tij", frame, frame)
    shear = np.einsum("tbi,taj->taibj", g, g) + np.einsum("tac,tbc,tij->taibj", m, m, plane)
    dilation = np.einsum("tai,tbj->taibj", g, g)
    area = geometry.area[:, None, None, None, None]
    return area * shear, area * dilation


def bending_stiffness(points: np.ndarray, geometry: ShellGeometry, nu: float) -> np.ndarray:
    """Rest stiffness of the bending for unit flexural rigidity, by pairs of hinges [N/m per N m].

    Args:
        points: Rest positions [m], shape (V, 3).
        geometry: Rest geometry of H hinges.
        nu: Poisson's ratio.

    Returns:
        Stiffness between the vertices of each hinge and those of each of its ``coupled``, shape (H, 5, 4, 3, 4, 3).
    """
    g = fold_gradients(points, geometry.hinges)
    stiffness = geometry.coupling @ np.array([1.0 - nu, nu])
    return np.einsum("hk,hai,hkbj->hkaibj", stiffness, g, g[geometry.coupled])


def tet_stiffness(points: np.ndarray, tets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the stiffness for unit shear modulus and unit second Lamé parameter [N/m per Pa], each (T, 4, 3, 4, 3).

    K_aibj = V (mu (g_a.g_b d_ij + g_aj g_bi) + lambda g_ai g_bj), g the shape gradients
    (Hughes, The Finite Element Method, section 2.7). It is the stable neo-Hookean Hessian at rest.
    """
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    inverse = np.linalg.inv(edges)
    gradient = np.concatenate([-inverse.sum(axis=2)[:, None], inverse.transpose(0, 2, 1)], axis=1)
    volume = (np.abs(np.linalg.det(edges)) / 6.0)[:, None, None, None, None]
    shear = np.einsum("tak,tbk,ij->taibj", gradient, gradient, np.eye(3))
    shear += np.einsum("taj,tbi->taibj", gradient, gradient)
    return volume * shear, volume * np.einsum("tai,tbj->taibj", gradient, gradient)
