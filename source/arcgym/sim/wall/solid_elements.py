# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small-strain stiffness of linear tetrahedra, in numpy."""

from __future__ import annotations

import numpy as np


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
