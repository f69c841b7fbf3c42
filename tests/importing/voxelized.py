# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Label volumes of generated colons, with what makes segmentations of CT colonography hard."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import trimesh
from scipy import ndimage
from scipy.spatial import cKDTree

from arcgym.anatomy import ColonStage
from arcgym.anatomy.importing.surfaces import read_surface
from arcgym.anatomy.polyline import resample, smooth
from arcgym.anatomy.voxel_grid import Grid

SPACING = np.array([0.75, 0.75, 1.0])
"""Voxels of the label volumes [mm]."""

_VOXEL = 0.001
_MARGIN = 30
_LPS = np.array([-1.0, -1.0, 1.0])
Edit = Callable[[Grid, ColonStage], None]


def write_voxelized(stage: ColonStage, path: Path, direction: np.ndarray, edits: Sequence[Edit]) -> Path:
    """Write a colon's lumen, changed by edits in turn, as labels 0 and 1 with a direction matrix."""
    import SimpleITK as sitk

    surface = path.with_suffix(".ply")
    trimesh.Trimesh(stage.visual.points, stage.visual.faces, process=False).export(surface)
    grid, _ = read_surface(surface, "m", None, _VOXEL)
    grid = Grid(np.pad(grid.values, _MARGIN), grid.origin - _MARGIN * _VOXEL, _VOXEL)
    for edit in edits:
        edit(grid, stage)
    image = sitk.GetImageFromArray(grid.values.transpose(2, 1, 0))
    image.SetSpacing([1e3 * _VOXEL] * 3)
    image.SetDirection(np.diag(_LPS).ravel().tolist())
    image.SetOrigin((1e3 * grid.origin * _LPS).tolist())
    corners = np.indices((2, 2, 2)).reshape(3, -1).T * (np.array(grid.values.shape) - 1)
    local = 1e3 * grid.points(corners) * _LPS @ direction
    size = np.ceil(np.ptp(local, axis=0) / SPACING).astype(int) + 1
    origin = (direction @ local.min(0)).tolist()
    turned = (origin, SPACING.tolist(), direction.ravel().tolist(), 0.0)
    made = sitk.Resample(image, size.tolist(), sitk.Transform(), sitk.sitkLinear, *turned)
    sitk.WriteImage(sitk.Cast(made > 0.5, sitk.sitkUInt8), str(path), True)
    return path


def place(stage: ColonStage, s: float | np.ndarray) -> np.ndarray:
    """Return positions on the centerline [m], shape (..., 3)."""
    line = stage.centerline
    return np.stack([np.interp(s, line.arc, line.points[:, k]) for k in range(3)], -1)


def gap(s: float, length: float, thread: float = 0.0, fluid: bool = False) -> Edit:
    """Leave a stretch out, or all but a thread of some radius, or only its posterior half, as unlabeled fluid [m]."""

    def edit(grid: Grid, stage: ColonStage) -> None:
        arc = np.arange(0.0, stage.length, 0.001)
        index = np.argwhere(grid.mask)
        points = grid.points(index)
        nearest = cKDTree(place(stage, arc)).query(points)[1]
        gone = (arc[nearest] > s) & (arc[nearest] < s + length)
        gone &= (points[:, 1] < place(stage, arc[nearest])[:, 1]) | (not fluid)
        grid.values[tuple(index[gone].T)] = 0.0
        if thread:
            _draw(grid, place(stage, np.arange(s - 0.005, s + length + 0.005, 0.001)), thread)

    return edit


def noise(grid: Grid, stage: ColonStage) -> None:
    """Drop every seventh voxel at the wall and set 300 specks."""
    rng = np.random.default_rng(0)
    mask = grid.mask
    edge = np.argwhere(mask & ~ndimage.binary_erosion(mask))
    grid.values[tuple(edge[rng.random(len(edge)) < 0.15].T)] = 0.0
    for x, y, z in (rng.random((300, 3)) * mask.shape).astype(int):
        grid.values[x : x + 2, y : y + 2, z : z + 2] = 1.0


def rectal_tube(grid: Grid, stage: ColonStage) -> None:
    """Add a tube that is 9 mm wide and ends below the anus, and its hole within the rectum."""
    _draw(grid, np.linspace([0.0, 0.0, -0.028], [0.0, 0.0, 0.01], 60), 0.0045)
    _draw(grid, place(stage, np.arange(0.01, 0.05, 0.001)), 0.005, 0.0)


def small_bowel(share: float, radius: float = 0.009) -> Edit:
    """Add a loop from the ileocecal valve towards the sigmoid; with a share of 1 it joins that, too."""

    def edit(grid: Grid, stage: ColonStage) -> None:
        line = _free_way(grid, place(stage, stage.landmarks["ileocecal_valve"]), place(stage, 0.45))
        outside = np.flatnonzero(grid.sample(line) < 0.5)
        line = line[: outside[0] + round(share * (outside[-1] - outside[0])) + 3]
        room = cKDTree(stage.visual.points).query(line)[0] - 0.002
        for point, wide in zip(line, np.clip(room, 0.004, radius), strict=True):
            _draw(grid, point[None], 0.004 if grid.sample(point[None])[0] > 0.5 else float(wide))

    return edit


def _free_way(grid: Grid, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return a way [m] between two places that keeps off the colon, shape (n, 3)."""
    from skimage.graph import route_through_array

    room = ndimage.distance_transform_edt(~grid.mask, sampling=grid.spacing)[::4, ::4, ::4]
    ends = [np.rint(grid.index(point) / 4).astype(int) for point in (first, last)]
    way, _ = route_through_array(1.0 + 4e6 * np.clip(0.013 - room, 0.0, None) ** 2, *ends, geometric=True)
    return smooth(resample(grid.points(4 * np.array(way)), 0.002), 4.0)


def _draw(grid: Grid, line: np.ndarray, radius: float, value: float = 1.0) -> None:
    """Set the voxels within a radius of points [m], shape (n, 3)."""
    low = np.maximum(np.floor(grid.index(line.min(0) - radius)).astype(int), 0)
    high = np.ceil(grid.index(line.max(0) + radius)).astype(int) + 1
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    index = np.indices(grid.values[box].shape).reshape(3, -1).T + low
    near = cKDTree(line).query(grid.points(index), distance_upper_bound=radius)[0] < radius
    grid.values[tuple(index[near].T)] = value
