# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Way through the lumen from one end to the other, kept in its middle so that touching loops are not short-cut."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from arcgym.anatomy.importing.clearance import coarse_clearance
from arcgym.anatomy.importing.ends import Course, find_course
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.leaks import cut_off, fill_tube
from arcgym.anatomy.importing.poles import off_the_wall, to_pole
from arcgym.anatomy.importing.smooth_centerline import resample
from arcgym.anatomy.importing.tree import LumenTree, lumen_tree

_SHORTEST = 0.4
_WIDEST = 0.065
_FARTHEST_END = 0.05
_CECUM_LOOK = 0.04
LEAST_HOLE = 3e-7
"""Holes in the rectum below this volume [m^3] are folds and noise, and are not told."""


@dataclass(frozen=True)
class FoundPath:
    """Way through the colon and what was changed in the lumen to find it."""

    points: np.ndarray
    """Positions from one end to the other [m], shape (n, 3)."""
    cut: list[dict[str, Any]]
    """What hung on the colon and was cut off."""
    filled_hole: float
    """Volume of the holes in the rectum, such as a tube's, that were filled [m^3]."""


def find_path(grid: Grid, ends: list[np.ndarray | None], frame: str) -> FoundPath:
    """Finds the way between both ends of the colon and cuts off, in the grid, what hangs on it.

    Args:
        grid: The cleaned lumen; its values are changed where something is cut off or filled.
        ends: Position of the anus and of the caecal pole [m], or None to find them.
        frame: How the grid's axes lie in the patient: a key of ``FRAMES``, or ``auto``.

    Raises:
        ColonImportError: A given end is not in the lumen, or the lumen is too wide or too short for a colon.
    """
    tree, course, clearance = _search(grid, ends, frame)
    hole = fill_tube(grid, tree.points[course.nodes[0]])
    if hole > LEAST_HOLE:
        tree, course, clearance = _search(grid, ends, frame)
    cut = cut_off(grid, course.attached, tree.points[course.nodes], tree.clearance[course.nodes])
    if cut:
        tree, course, clearance = _search(grid, ends, frame, prune=False)
    points = resample(tree.points[course.nodes], 2 * grid.spacing)
    points = to_pole(clearance, points, _CECUM_LOOK) if ends[1] is None else points
    points = off_the_wall(clearance, points[::-1])[::-1] if ends[0] is None else points
    length = float(np.linalg.norm(np.diff(points[::5], axis=0), axis=1).sum())
    if length < _SHORTEST:
        raise ColonImportError(
            f"No colon-like component: the lumen's centreline is only {1e3 * length:.0f} mm long",
            "Check the units (--spacing, --units), --label, --max-gap and --anus/--cecum.",
        )
    return FoundPath(points, cut, hole)


def _search(
    grid: Grid, ends: list[np.ndarray | None], frame: str, prune: bool = True
) -> tuple[LumenTree, Course, Grid]:
    clearance = coarse_clearance(grid)
    widest = float(clearance.values.max())
    if widest > _WIDEST:
        raise ColonImportError(
            f"No colon-like component: a ball of {2e3 * widest:.0f} mm fits in; a colon is below "
            f"{2e3 * _WIDEST:.0f} mm wide",
            "Pass the mask of the colon's lumen, and --label and the units (--spacing, --units) if they are wrong.",
        )
    given = [None if end is None else _nearest_voxel(clearance, end) for end in ends]
    tree = lumen_tree(clearance, [voxel for voxel in given if voxel is not None])
    fixed: tuple[int | None, int | None]
    if ends[0] is not None:
        fixed = (0, None if ends[1] is None else tree.tips[1])
    else:
        fixed = (None, None if ends[1] is None else 0)
    return tree, find_course(tree, frame, fixed, prune), clearance


def _nearest_voxel(clearance: Grid, point: np.ndarray) -> np.ndarray:
    inside = np.argwhere(clearance.values > 0)
    distance = np.linalg.norm(clearance.points(inside) - point, axis=1)
    if distance.min() > _FARTHEST_END:
        where = ", ".join(f"{1e3 * value:.0f}" for value in point)
        raise ColonImportError(
            f"The end given at {where} mm is {1e3 * distance.min():.0f} mm away from the lumen",
            "Pass --anus and --cecum in millimetres along the patient's right, anterior and cranial axes.",
        )
    near = inside[distance < distance.min() + 0.012]
    return near[clearance.values[tuple(near.T)].argmax()]
