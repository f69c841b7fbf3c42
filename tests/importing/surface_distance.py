# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far an imported surface is from another one."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.validation.surface_distance import surface_samples as spread


def surface_samples(points: np.ndarray, faces: np.ndarray, spacing: float) -> np.ndarray:
    """Return random points spread evenly over a surface, about one per square of edge ``spacing``, shape (n, 3)."""
    a, b, c = (points[faces[:, k]].astype(float) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    return spread(points, faces, int(area / spacing**2))


def hausdorff95(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
    """Return the 95th percentile of the distance from ``a`` to ``b`` and from ``b`` to ``a``.

    Args:
        a: Samples of one surface [m], shape (n, 3).
        b: Samples of the other [m], shape (m, 3).
    """
    there, back = cKDTree(b).query(a)[0], cKDTree(a).query(b)[0]
    return float(np.quantile(there, 0.95)), float(np.quantile(back, 0.95))
