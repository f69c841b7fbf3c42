# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small-strain stiffness of a shell's triangles and hinges, in numpy."""

from __future__ import annotations

import numpy as np

from arcgym.assets.shell_geometry import ShellGeometry, fold_gradients


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


def bending_bound(points: np.ndarray, geometry: ShellGeometry) -> np.ndarray:
    """Stiffness that is nowhere below that of the bending, hinge by hinge, shape (H, 4, 3, 4, 3)."""
    g = fold_gradients(points, geometry.hinges)
    return np.einsum("h,hai,hbj->haibj", geometry.bound, g, g)
