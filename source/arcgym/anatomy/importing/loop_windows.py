# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Windows between loops that touch are closed in the lumen; :mod:`arcgym.anatomy.meshing.voxel_surface` finds them."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.anatomy.importing.cleaning import in_millimeters
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.meshing import voxel_surface
from arcgym.anatomy.voxel_grid import Grid


def close_windows(grid: Grid, line: np.ndarray) -> tuple[Grid, list[dict[str, Any]]]:
    """Put a wall of two voxels into the windows between loops.

    Args:
        grid: The lumen.
        line: Its centerline [m], shape (n, 3).

    Returns:
        The lumen, and area, arc lengths and place of each window.

    Raises:
        ColonImportError: The walls would cut the colon.
    """
    try:
        found = voxel_surface.separate_loops(grid.values, grid.origin, grid.spacing, line)
    except ValueError as error:
        raise ColonImportError(str(error), "Pass --anus and --cecum if the ends are wrong.") from error
    if not found.windows:
        return grid, []
    values = np.where(grid.mask & ~found.lumen, 0.0, grid.values).astype(np.float32)
    windows = [
        {
            "area_mm2": round(1e6 * window.area),
            "at_mm": [round(1e3 * arc) for arc in window.arcs],
            "place_mm": in_millimeters(window.position),
        }
        for window in found.windows[:20]
    ]
    return Grid(values, grid.origin, grid.spacing), windows
