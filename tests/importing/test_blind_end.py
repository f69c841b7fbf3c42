# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The blind end is where the way is longest: a bulge of the wall beside the way is not taken for it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.blind_end import blind_end
from arcgym.anatomy.importing.cecum_fit import lead_to_fitted_pole
from arcgym.anatomy.importing.smooth_centerline import plain_curve
from arcgym.anatomy.polyline import resample
from arcgym.anatomy.voxel_grid import Grid

VOXEL = 0.002
DOWN = np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, -0.20], 200)


def lumen(*tubes: tuple[np.ndarray, float]) -> Grid:
    """Return the union of balls of a radius [m] along lines (n, 3)."""
    points = np.concatenate([line for line, _ in tubes])
    low, high = points.min(0) - 0.05, points.max(0) + 0.05
    size = np.ceil((high - low) / VOXEL).astype(int)
    grid = Grid(np.zeros(size, np.float32), low, VOXEL)
    voxels = grid.points(np.indices(size).reshape(3, -1).T)
    inside = np.any([cKDTree(line).query(voxels)[0] < radius for line, radius in tubes], axis=0)
    grid.values[:] = inside.reshape(size)
    return grid


def test_bulge_beside_the_way_is_no_end() -> None:
    """From 10 cm above, the dome's tip is 10 + 2 cm away, the bulge's farthest place hypot(5, 6) = 8 cm.

    Places are 4 mm apart.
    """
    bulge = np.array([[0.03, 0.0, -0.15]])
    line = np.concatenate([DOWN, [[0.0, 0.0, -0.22]]])
    found = blind_end(lumen((DOWN, 0.02), (bulge, 0.03)), plain_curve(resample(line, 0.003)), 0.10, 0.02)
    assert np.linalg.norm(found - [0.0, 0.0, -0.22]) < 0.008


def test_path_is_turned_to_an_end_that_the_fit_misses() -> None:
    """A wide pouch ends 32 mm below; a narrower one goes on to the back, 46 + 14 mm, 45 degrees down."""
    aslant = np.array([0.0, -1.0, -1.0]) / np.sqrt(2.0)
    back = DOWN[-1] + np.linspace(0.0, 0.046, 50)[:, None] * aslant
    grid = lumen((DOWN, 0.032), (back, 0.014))
    to_the_wide_one = resample(np.concatenate([DOWN, [[0.0, 0.0, -0.232]]]), 0.003)
    end = DOWN[-1] + 0.060 * aslant
    found = lead_to_fitted_pole(grid, to_the_wide_one)
    assert np.linalg.norm(to_the_wide_one[-1] - end) > 0.040
    assert np.linalg.norm(found[-1] - end) < 0.008
    assert (grid.sample(found[:-3]) > 0.5).all()
