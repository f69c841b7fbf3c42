# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Thickness of a wall by the colon's diameter, in numpy."""

from __future__ import annotations

import numpy as np

from arcgym.assets.wall_law_cfg import WallLawCfg


def thickness_shares(law: WallLawCfg, points: np.ndarray, ring: np.ndarray, thickness: float) -> np.ndarray:
    """Return the thickness of each ring over the tissue's, shape (R,); 1 unless it goes by the diameter.

    Args:
        law: Settings.
        points: Rest positions [m], shape (V, 3).
        ring: Ring of each vertex, shape (V,).
        thickness: Thickness of the tissue [m].
    """
    count = int(ring.max()) + 1
    if not law.thickness_by_diameter:
        return np.ones(count)
    members = np.bincount(ring, minlength=count)
    center = np.zeros((count, 3))
    np.add.at(center, ring, points.astype(np.float64))
    center /= members[:, None]
    radius = np.bincount(ring, np.linalg.norm(points - center[ring], axis=1), count) / members
    own = law.thickness_times_diameter / np.maximum(2.0 * radius, 1.0e-6)
    return np.clip(own, *law.thickness_range) / thickness
