# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Clearance of the lumen's voxels from its wall, and the cost of passing them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter

from arcgym.anatomy.voxel_grid import Grid

OUTSIDE = -1.0
"""Cost of voxels that no path may enter, as scikit-image wants it."""

_WIDE = (0.010, 0.016)
"""Range of clearances below which passing costs [m]: a fold leaves more room than that."""

_WIDE_SHARE = 0.6
"""That clearance as a share of the lumen's radius nearby."""

_REACH = 0.013
"""Distance within which the lumen's radius is taken [m]."""

_POWER = 6
"""Power by which the cost rises as the clearance falls."""

_DEAREST = 2e4
"""Largest cost of a voxel."""


def coarse_clearance(grid: Grid) -> Grid:
    """Return the distance to the wall [m] on voxels of twice the size, the largest of eight: nothing is cut off."""
    import SimpleITK as sitk

    mask = grid.mask
    mask = np.pad(mask, [(0, size % 2) for size in mask.shape])
    image = sitk.GetImageFromArray(mask.astype(np.uint8))
    inside = sitk.SignedMaurerDistanceMap(image, insideIsPositive=True, squaredDistance=False)
    distance = np.where(mask, sitk.GetArrayViewFromImage(inside) + 1.0, 0.0).astype(np.float32)
    x, y, z = (size // 2 for size in mask.shape)
    blocks = distance.reshape(x, 2, y, 2, z, 2).max(axis=(1, 3, 5))
    return Grid(grid.spacing * blocks, grid.origin + 0.5 * grid.spacing, 2 * grid.spacing)


def widest_near(clearance: Grid) -> np.ndarray:
    """Return the largest clearance within 13 mm of each voxel [m], same shape."""
    size = 2 * round(_REACH / clearance.spacing) + 1
    return maximum_filter(clearance.values, size)


def passing_cost(clearance: Grid, widest: np.ndarray) -> np.ndarray:
    """Return the cost of passing each voxel, :data:`OUTSIDE` beyond the wall.

    It rises with the sixth power of the nearness of the wall once that is below 10 to 16 mm, or 0.6 times the lumen's
    radius: a fold leaves more room than that, a window between two touching loops does not, so that a path goes the
    long way round rather than through the window.
    """
    wide = np.clip(_WIDE_SHARE * widest, *_WIDE)
    narrow = (wide / np.maximum(clearance.values, 1e-6)) ** _POWER
    return np.where(clearance.values > 0, 1.0 + np.minimum(narrow, _DEAREST), OUTSIDE)
