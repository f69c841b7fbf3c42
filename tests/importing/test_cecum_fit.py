# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The pole of a pouch is the end of its axis, wherever the way to it begins to go wrong."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.cecum_fit import lead_to_fitted_pole
from arcgym.anatomy.polyline import resample
from arcgym.anatomy.voxel_grid import Grid

RADIUS, LENGTH, BEND = 0.030, 0.25, 4.0


def axis(s: np.ndarray) -> np.ndarray:
    """Run down and, over its last 12 cm, forwards [m], shape (n, 3)."""
    angle = BEND * np.maximum(s - LENGTH + 0.12, 0.0)
    way = np.stack([0 * s, np.sin(angle), -np.cos(angle)], 1)
    return np.cumsum(way, axis=0) * (s[1] - s[0])


@pytest.mark.parametrize("sideways", [(0.015, 0.0), (0.0, -0.012), (-0.012, 0.012)])
def test_pole_is_the_end_of_the_axis(sideways: tuple[float, float]) -> None:
    """A path that strays to the side of the pouch by 12 to 17 mm is led back to within 6 mm of its pole."""
    line = axis(np.linspace(0.0, LENGTH, 500))
    size = np.ceil((np.ptp(line, axis=0) + 0.08) / 0.002).astype(int)
    grid = Grid(np.zeros(size, np.float32), line.min(0) - 0.04, 0.002)
    voxels = grid.points(np.indices(size).reshape(3, -1).T)
    inside = cKDTree(line[line[:, 2] > line[-1, 2] - 1.0]).query(voxels)[0] < RADIUS
    grid.values[:] = inside.reshape(size)
    pole = line[-1] + RADIUS * (line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2])
    wrong = np.concatenate([line[::6], line[-1:] + [[*sideways, -0.02]]])
    found = lead_to_fitted_pole(grid, resample(wrong, 0.003))
    assert np.linalg.norm(found[-1] - pole) < 0.006
