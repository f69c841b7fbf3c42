# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon's lumen and the way through it, as found in a file: all that comes before rings and meshes."""

from __future__ import annotations

import logging
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter

from arcgym.anatomy.importing.canal import straighten_canal
from arcgym.anatomy.importing.cleaning import Cleaning, keep_colon
from arcgym.anatomy.importing.formats import FRAMES, VOLUME_SUFFIXES
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.headroom import widen_for_head
from arcgym.anatomy.importing.openings import Opening, find_openings
from arcgym.anatomy.importing.orientation import Orientation, orient
from arcgym.anatomy.importing.path_search import LEAST_HOLE, find_path
from arcgym.anatomy.importing.placement import turned_grid
from arcgym.anatomy.importing.preflight import check_input
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.size_limits import check_filling
from arcgym.anatomy.importing.smooth_centerline import center_path
from arcgym.anatomy.importing.surfaces import fill_surface, load_surface
from arcgym.anatomy.importing.volumes import read_volume

_LOGGER = logging.getLogger(__name__)

_SMOOTHING = 0.0006
"""Standard deviation of the smoothing of the lumen once it is cleaned [m]."""


class Progress:
    """Logs and times the stages of an import."""

    def __init__(self) -> None:
        """Start the clock."""
        self.seconds: dict[str, float] = {}
        """Time of each stage [s]."""
        self._start = time.perf_counter()

    def done(self, stage: str, message: str) -> None:
        """Log a stage that is done."""
        now = time.perf_counter()
        self.seconds[stage] = round(now - self._start, 2)
        self._start = now
        _LOGGER.info("%-11s %5.1f s  %s", stage, self.seconds[stage], message)


@dataclass(frozen=True)
class Lumen:
    """One connected lumen from anus to caecum on voxels, in the patient's frame."""

    grid: Grid
    """The lumen, everything that is not colon cut off; axes right, anterior, cranial."""
    line: np.ndarray
    """Its centerline from the anal verge to the caecal pole, evenly spaced; straight in the canal [m], shape (n, 3)."""
    orientation: Orientation
    """How the file's axes lie in the patient."""
    report: dict[str, Any] = field(default_factory=dict)
    """Figures of what was read, cleaned and found."""

    @property
    def rotation(self) -> np.ndarray:
        """From the file's axes to the patient's, shape (3, 3)."""
        return FRAMES[self.orientation.frame]


def find_lumen(path: Path, settings: ImportSettings, progress: Progress) -> Lumen:
    """Read a file and find the colon in it.

    Args:
        path: Label volume or surface.
        settings: What the caller knows better.
        progress: Told when a stage is done.

    Raises:
        ColonImportError: The input cannot become a colon; says what was found and what to pass.
    """
    check_input(path)
    grid, openings, source = _read(path, settings)
    progress.done("read", f"{grid.mask.sum() * grid.spacing**3 * 1e6:.0f} ml in {'x'.join(map(str, grid.mask.shape))}")
    grid, cleaning = keep_colon(grid, settings.max_gap)
    progress.done(
        "clean", f"{cleaning.pieces} pieces, {len(cleaning.bridges)} bridged, {len(cleaning.dropped)} dropped"
    )
    points, orientation = _find_path(grid, settings, source["kind"] == "surface", cleaning)
    rotation = FRAMES[orientation.frame]
    grid, points = turned_grid(grid, points, rotation)
    grid = Grid(gaussian_filter(grid.values, _SMOOTHING / grid.spacing), grid.origin, grid.spacing)
    line = center_path(grid, points, settings.cecum is None, [opening.turned(rotation) for opening in openings])
    progress.done("centreline", f"likeness {orientation.likeness:.2f}, frame {orientation.frame}")
    grid, line, canal = straighten_canal(grid, line)
    grid, widened = widen_for_head(grid, line, settings.min_lumen_radius)
    progress.done("passage", f"canal turned by {canal['turn_deg']:.0f} deg, {widened['share']:.0%} of the way widened")
    report = {
        "input": {"file": path.name, **source},
        "cleaning": asdict(cleaning),
        "orientation": asdict(orientation),
        "canal": canal,
        "widened_for_head": widened,
    }
    return Lumen(grid, line, orientation, report)


def _read(path: Path, settings: ImportSettings) -> tuple[Grid, list[Opening], dict[str, str]]:
    """Return the lumen, where it is open if it was a surface, and what was read."""
    if path.name.lower().endswith(VOLUME_SUFFIXES):
        grid = read_volume(path, settings.label, settings.spacing, settings.voxel)
        return grid, [], {"kind": "volume", "units": "mm"}
    points, faces, unit = load_surface(path, settings.units, settings.spacing)
    grid = fill_surface(points, faces, settings.voxel)
    check_filling(grid.mask)
    return grid, find_openings(points, faces), {"kind": "surface", "units": unit}


def _find_path(
    grid: Grid, settings: ImportSettings, is_surface: bool, cleaning: Cleaning
) -> tuple[np.ndarray, Orientation]:
    """Return the path from anus to cecum on the file's axes, and how these lie in the patient; notes what was cut."""
    ends = [None if end is None else 1e-3 * np.array(end) for end in (settings.anus, settings.cecum)]
    frame = settings.frame if is_surface else "ras"
    found = find_path(grid, ends, frame)
    orientation = orient(found.points, frame, ends_known=any(end is not None for end in ends))
    cleaning.cut = found.cut
    if found.filled_hole > LEAST_HOLE:
        cleaning.cut.append({"kind": "hole in the rectum, filled", "volume_ml": round(1e6 * found.filled_hole, 1)})
    return (found.points[::-1] if orientation.reversed else found.points), orientation
