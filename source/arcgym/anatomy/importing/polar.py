# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Distance from the centerline to the wall in every direction, by rays through the grid."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.voxel_grid import Grid

REACH = 0.060
"""Length of the rays [m]."""

_STEP = 0.0006
"""Distance of the samples along a ray [m]."""

_CHUNK = 200
"""Cross-sections that are cast at once, which bounds the memory."""


def cast_rings(grid: Grid, curve: Curve, s: np.ndarray, sectors: int) -> np.ndarray:
    """Cast rays in the plane across the curve at each ``s``.

    Returns:
        Distance to where the lumen ends [m], shape (n, sectors); sector j stands at ``2 pi j / sectors``.
    """
    theta = np.arange(sectors) * 2 * np.pi / sectors
    return cast(grid, curve.position(s), curve.outwards(s[:, None], theta))


def cast(grid: Grid, centers: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Cast rays from centers, shape (n, 3), in unit directions, shape (n, k, 3); returns lengths [m], (n, k)."""
    rho = _STEP * np.arange(round(REACH / _STEP) + 1)
    out = np.zeros(directions.shape[:2])
    for start in range(0, len(centers), _CHUNK):
        part = slice(start, start + _CHUNK)
        points = centers[part, None, None] + rho[:, None] * directions[part, :, None]
        value = grid.sample(points)
        outside = value < 0.5
        first = np.where(outside.any(-1), outside.argmax(-1), len(rho) - 1)
        before = np.maximum(first - 1, 0)
        high = np.take_along_axis(value, before[..., None], -1)[..., 0]
        low = np.take_along_axis(value, first[..., None], -1)[..., 0]
        share = np.clip((high - 0.5) / np.maximum(high - low, 1e-6), 0.0, 1.0)
        out[part] = _STEP * (before + np.where(first > 0, share, 0.0))
    return out
