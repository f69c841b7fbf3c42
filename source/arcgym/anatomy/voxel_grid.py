# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scalar field on an isotropic grid along the patient's axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates


@dataclass(frozen=True)
class Grid:
    """Values at voxel centers; axes are the patient's: +X right, +Y anterior, +Z cranial."""

    values: np.ndarray
    """One value a voxel, shape (X, Y, Z); the lumen is where it is above 0.5."""
    origin: np.ndarray
    """Center of the first voxel [m], shape (3,)."""
    spacing: float
    """Edge of a voxel [m]."""

    @property
    def mask(self) -> np.ndarray:
        """Whether each voxel is lumen, shape (X, Y, Z), bool."""
        return self.values > 0.5

    def points(self, index: np.ndarray) -> np.ndarray:
        """Return positions [m] of voxel indices, both of shape (n, 3)."""
        return self.origin + self.spacing * np.asarray(index, float)

    def index(self, points: np.ndarray) -> np.ndarray:
        """Return fractional voxel indices of positions [m], same shape."""
        return (np.asarray(points) - self.origin) / self.spacing

    def sample(self, points: np.ndarray) -> np.ndarray:
        """Interpolate linearly at positions [m], shape (..., 3); 0 outside the grid."""
        index = np.moveaxis(self.index(points), -1, 0).astype(np.float32)
        return map_coordinates(self.values, index, order=1, mode="constant", output=np.float32)
