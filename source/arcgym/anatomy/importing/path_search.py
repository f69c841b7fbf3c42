# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The path through the lumen on voxels, end to end, kept in the middle: touching loops are not short-cut.

:mod:`smooth_centerline` makes the smooth curve of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.cleaning import in_millimeters
from arcgym.anatomy.importing.clearance import coarse_clearance
from arcgym.anatomy.importing.colon_path import ColonPath, find_colon_path
from arcgym.anatomy.importing.cutting import as_report, cut_off, fill_tube
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.poles import lead_to_pole, trim_open_end
from arcgym.anatomy.importing.short_cuts import without_short_cuts
from arcgym.anatomy.importing.tree import LumenTree, caliber, lumen_tree
from arcgym.anatomy.polyline import resample
from arcgym.anatomy.tubes import box_near
from arcgym.anatomy.voxel_grid import Grid

_SHORTEST = 0.4
"""Least length of a path through a colon [m]; adults have three times as much."""

_WIDEST = 0.065
"""Largest radius of a ball that fits into a colon [m]; radiology's upper bound for the cecum is 0.045."""

_FARTHEST_END = 0.05
"""Largest distance of a given end from the lumen [m]."""

_CECUM_LOOK = 0.04
"""Length of the path's end in which the widest place of the cecum is sought [m]."""

_END_REACH = 0.012
"""How much farther than the nearest voxel a given end may be moved, to where the lumen is widest [m]."""

LEAST_HOLE = 3e-7
"""Least volume of a hole in the rectum that is reported [m^3]; smaller ones are folds and noise."""


@dataclass(frozen=True)
class FoundPath:
    """Path through the colon and what was changed in the lumen to find it."""

    points: np.ndarray
    """Positions from one end to the other [m], shape (n, 3)."""
    cut: list[dict[str, Any]]
    """What hung on the colon and was cut off."""
    filled_hole: float
    """Volume of the holes in the rectum, such as a tube's, that were filled [m^3]."""
    pouches: list[dict[str, Any]] = field(default_factory=list)
    """What sticks out of the colon and was left."""
    closed: list[dict[str, Any]] = field(default_factory=list)
    """Windows between loops that the path would have taken as a short cut, and that were closed."""
    caliber: float = 0.0
    """Radius of the colon between folds, in the middle of its values [m]."""
    lost: float = 0.0
    """Volume of what lost its connection to the colon with what was cut off [m^3]."""


def find_path(grid: Grid, ends: list[np.ndarray | None], frame: str) -> FoundPath:
    """Find the path between both ends of the colon and cuts off, in the grid, what hangs on it.

    Args:
        grid: The cleaned lumen; its values are changed where something is cut off or filled.
        ends: Position of the anus and of the cecal pole [m], or None to find them.
        frame: How the grid's axes lie in the patient: a key of ``FRAMES``, or ``auto``.

    Raises:
        ColonImportError: A given end is not in the lumen, or the lumen is too wide or too short for a colon.
    """
    tree, colon, clearance = _search(grid, ends, frame)
    volume = _volume(grid)
    hole = fill_tube(grid, tree.points[colon.nodes[0]])
    if hole > LEAST_HOLE:
        tree, colon, clearance = _search(grid, ends, frame)
    blocked, tree, colon, windows = without_short_cuts(
        clearance, tree, colon, lambda other: _path_in(other, ends, frame, True)
    )
    cut = cut_off(grid, colon.attached, tree.points[colon.nodes], tree.clearance[colon.nodes])
    pouches = [as_report(piece) for piece in colon.pouches]
    walled = Grid(grid.values.copy(), grid.origin, grid.spacing) if windows else grid
    closed = [_close(walled, window, blocked.spacing) for window in windows]
    if cut or closed:
        tree, colon, clearance = _search(walled, ends, frame, prune=False)
    points = resample(tree.points[colon.nodes], 2 * grid.spacing)
    points = lead_to_pole(clearance, points, _CECUM_LOOK) if ends[1] is None else points
    points = trim_open_end(clearance, points[::-1])[::-1] if ends[0] is None else points
    length = float(np.linalg.norm(np.diff(points[::5], axis=0), axis=1).sum())
    if length < _SHORTEST:
        raise ColonImportError(
            f"No colon-like component: the lumen's centerline is only {1e3 * length:.0f} mm long",
            "Check the units (--spacing, --units), --label, --max-gap and --anus/--cecum.",
        )
    wide = float(np.median(caliber(tree.clearance[colon.nodes], tree.points[colon.nodes])))
    lost = volume + hole - _volume(grid) - 1e-6 * sum(piece["volume_ml"] for piece in cut)
    return FoundPath(points, cut, hole, pouches, closed, wide, max(lost, 0.0))


def _volume(grid: Grid) -> float:
    return float(grid.mask.sum()) * grid.spacing**3


def _close(grid: Grid, window: np.ndarray, voxel: float) -> dict[str, Any]:
    """Put a wall into a window, in place, and return its area and place for the report."""
    index = np.argwhere(grid.values[box := box_near(grid, window, voxel)] > 0) + [side.start for side in box]
    points = grid.points(index)
    wall = np.abs(points[:, None] - window[cKDTree(window).query(points)[1]][:, None]).max((1, 2)) <= 0.5 * voxel
    grid.values[tuple(index[wall].T)] = 0.0
    return {"area_mm2": round(1e6 * len(window) * voxel**2 / 2), "place_mm": in_millimeters(window.mean(0))}


def _search(
    grid: Grid, ends: list[np.ndarray | None], frame: str, prune: bool = True
) -> tuple[LumenTree, ColonPath, Grid]:
    clearance = coarse_clearance(grid)
    widest = float(clearance.values.max())
    if widest > _WIDEST:
        raise ColonImportError(
            f"No colon-like component: a ball of {2e3 * widest:.0f} mm fits in; a colon is below "
            f"{2e3 * _WIDEST:.0f} mm wide",
            "Pass the mask of the colon's lumen, and --label and the units (--spacing, --units) if they are wrong.",
        )
    return *_path_in(clearance, ends, frame, prune), clearance


def _path_in(clearance: Grid, ends: list[np.ndarray | None], frame: str, prune: bool) -> tuple[LumenTree, ColonPath]:
    """Return tree and path in the part of a lumen that is connected to its given end, or in the largest part."""
    clearance = _one_part(clearance, ends)
    given = [None if end is None else _nearest_voxel(clearance, end) for end in ends]
    tree = lumen_tree(clearance, [voxel for voxel in given if voxel is not None])
    fixed: tuple[int | None, int | None]
    if ends[0] is not None:
        fixed = (0, None if ends[1] is None else tree.tips[1])
    else:
        fixed = (None, None if ends[1] is None else 0)
    return tree, find_colon_path(tree, frame, fixed, prune)


def _one_part(clearance: Grid, ends: list[np.ndarray | None]) -> Grid:
    """Return a clearance with all but one connected part set to 0."""
    labels, count = ndimage.label(clearance.values > 0, np.ones((3, 3, 3)))
    if count < 2:
        return clearance
    end = next((end for end in ends if end is not None), None)
    keep = (
        labels[tuple(_nearest_voxel(clearance, end))]
        if end is not None
        else 1 + np.bincount(labels.ravel())[1:].argmax()
    )
    return Grid(np.where(labels == keep, clearance.values, 0.0).astype(np.float32), clearance.origin, clearance.spacing)


def _nearest_voxel(clearance: Grid, point: np.ndarray) -> np.ndarray:
    inside = np.argwhere(clearance.values > 0)
    distance = np.linalg.norm(clearance.points(inside) - point, axis=1)
    if distance.min() > _FARTHEST_END:
        where = ", ".join(f"{1e3 * value:.0f}" for value in point)
        raise ColonImportError(
            f"The end given at {where} mm is {1e3 * distance.min():.0f} mm away from the lumen",
            "Pass --anus and --cecum in millimeters along the patient's right, anterior and cranial axes.",
        )
    near = inside[distance < distance.min() + _END_REACH]
    return near[clearance.values[tuple(near.T)].argmax()]
