# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Label volumes of a known tube, for tests of the importer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

SITES = [
    (0.00, 0.00, 0.00),
    (0.00, -0.03, 0.06),
    (0.03, 0.03, 0.12),
    (-0.05, 0.06, 0.09),
    (-0.13, -0.02, 0.14),
    (-0.14, -0.04, 0.30),
    (-0.08, 0.04, 0.32),
    (0.00, 0.09, 0.24),
    (0.08, 0.04, 0.28),
    (0.14, -0.03, 0.26),
    (0.13, 0.00, 0.10),
]
"""Course of a small colon [m], +X right, +Y anterior, +Z cranial."""

RADIUS = 0.016
DIRECTIONS = {
    "identity": np.diag([1.0, 1.0, 1.0]),
    "flipped_xy": np.diag([-1.0, -1.0, 1.0]),
    "flipped_x": np.diag([-1.0, 1.0, 1.0]),
    "flipped_z": np.diag([1.0, 1.0, -1.0]),
    "permuted": np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]),
    "oblique": np.array([[0.96, -0.28, 0], [0.28, 0.96, 0], [0, 0, 1.0]]),
}
"""Direction matrices of label volumes, one of each kind."""


def course() -> tuple[np.ndarray, float]:
    """Return points every 2 mm [m], shape (n, 3), and the length [m]."""
    spline = CubicSpline(np.linspace(0, 1, len(SITES)), SITES)
    points = spline(np.linspace(0, 1, 2000))
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    even = np.linspace(0.0, arc[-1], round(arc[-1] / 0.002) + 1)
    return np.stack([np.interp(even, arc, points[:, k]) for k in range(3)], 1), float(arc[-1])


def write_volume(
    path: Path,
    direction: np.ndarray | None = None,
    gap: float = 0.0,
    extra: np.ndarray | None = None,
    voxel: float = 3.0,
    extra_radius: float = 0.010,
    value: int = 1,
) -> Path:
    """Write the tube as labels 0 and 1, voxels of some millimeters.

    Args:
        path: File to write.
        direction: Direction matrix, patient axes left, posterior, cranial.
        gap: Length that is left out in the middle [m].
        extra: Further points that are lumen [m], shape (n, 3).
        voxel: Edge of the voxels [mm].
        extra_radius: How far round these points [m].
        value: Label of these points.
    """
    import SimpleITK as sitk

    direction = np.eye(3) if direction is None else direction
    line, _ = course()
    middle, half = len(line) // 2, round(0.5 * gap / 0.002)
    parts = [(line[: middle - half], RADIUS), (line[middle + half :], RADIUS)]
    parts += [] if extra is None else [(extra, extra_radius)]
    lps = 1e3 * np.concatenate([part for part, _ in parts]) * [-1, -1, 1]
    local = lps @ direction
    low = local.min(0) - 30
    size = np.ceil((local.max(0) + 30 - low) / voxel).astype(int)
    index = np.stack(np.meshgrid(*(np.arange(n) for n in size), indexing="ij"), -1).reshape(-1, 3)
    world = (low + voxel * index) @ direction.T * [-1, -1, 1] * 1e-3
    labels = np.zeros(len(world), np.uint8)
    for k, (part, radius) in enumerate(parts):
        inside = np.isfinite(cKDTree(part).query(world, distance_upper_bound=radius)[0])
        labels[inside & (labels == 0)] = value if k == 2 else 1
    image = sitk.GetImageFromArray(labels.reshape(size).transpose(2, 1, 0))
    image.SetSpacing([voxel] * 3)
    image.SetDirection(direction.ravel().tolist())
    image.SetOrigin((low @ direction.T).tolist())
    sitk.WriteImage(image, str(path), True)
    return path
