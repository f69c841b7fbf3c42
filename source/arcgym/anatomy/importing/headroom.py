# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Widen a lumen where a scope's stiff head does not pass: collapsed stretches, folds and tight bends."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates

from arcgym.anatomy.head_drawing import draw_heads
from arcgym.anatomy.importing.cleaning import in_millimeters
from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.validation.passage import HEAD_LENGTH, HEAD_RADIUS, Passage, find_passage
from arcgym.anatomy.voxel_grid import Grid

_SPARED = 1.0, 0.0005, 0.0
"""What a head must be spared at least so as not to be drawn, in turn [m]: first all that was asked for, later less."""

_ENTRANCE = 0.008
"""Length at the verge that a head's axis does not enter [m]: on voxels the lumen is closed there."""


def signed_clearance(grid: Grid) -> Grid:
    """Return the distance to the wall at each voxel [m], negative outside the lumen.

    Maurer's distance is that to the middle of the lumen's last voxel; the wall is half a voxel beyond.
    """
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(grid.mask.astype(np.uint8))
    distance = sitk.SignedMaurerDistanceMap(image, insideIsPositive=True, squaredDistance=False)
    to_edge = sitk.GetArrayFromImage(distance) + 0.5
    return Grid(grid.spacing * to_edge, grid.origin, grid.spacing)


def room_for_head(grid: Grid, line: np.ndarray, radius: float = HEAD_RADIUS) -> Passage:
    """Return the room for a head in a lumen on voxels; one thicker than the scopes' has longer round ends.

    Args:
        grid: The lumen.
        line: Its centerline [m], shape (n, 3).
        radius: Radius of the head [m].
    """
    field = signed_clearance(grid)

    def clearance(points: np.ndarray) -> np.ndarray:
        index = np.moveaxis(field.index(points), -1, 0)
        return map_coordinates(field.values, index, order=1, mode="nearest")

    arc = arc_lengths(line)
    inside = arc >= _ENTRANCE
    return find_passage(clearance, line[inside], arc[inside], radius, HEAD_LENGTH + 2.0 * (radius - HEAD_RADIUS))


def widen_for_head(grid: Grid, line: np.ndarray, radius: float) -> tuple[Grid, dict[str, Any]]:
    """Draw the head where it does not pass, in the pose in which it needs least; a wall is left between two loops.

    Args:
        grid: The lumen.
        line: Its centerline [m], evenly spaced, shape (n, 3).
        radius: Radius of the head with what it is to be spared [m].

    Returns:
        The widened lumen, and figures: the share of the way, the least room before for a head of that radius and after
        for the scopes', and the volume that was added.
    """
    out = Grid(grid.values.copy(), grid.origin, grid.spacing)
    found = before = room_for_head(out, line, radius)
    for spared in _SPARED:
        poor = np.flatnonzero(found.room < min(radius, HEAD_RADIUS + spared))
        if not len(poor):
            break
        draw_heads(out, grid, line, found, poor, radius)
        found = room_for_head(out, line)
    added = float((out.values > 0.5).sum() - (grid.values > 0.5).sum()) * grid.spacing**3
    tightest = line[min(int(np.searchsorted(arc_lengths(line), found.tightest)), len(line) - 1)]
    return out, {
        "share": round(float((before.room < radius).mean()), 3),
        "least_room_mm": round(1e3 * before.least, 2),
        "least_room_after_mm": round(1e3 * found.least, 2),
        "tightest_at_mm": round(1e3 * found.tightest),
        "place_mm": in_millimeters(tightest),
        "added_ml": round(1e6 * added, 1),
    }
