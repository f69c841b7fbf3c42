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
from arcgym.anatomy.importing.cecal_openings import CecalOpening, cecal_openings
from arcgym.anatomy.importing.cleaning import keep_colon
from arcgym.anatomy.importing.doubts import path_doubts, refuse
from arcgym.anatomy.importing.formats import FRAMES, VOLUME_SUFFIXES
from arcgym.anatomy.importing.headroom import widen_for_head
from arcgym.anatomy.importing.loop_windows import close_windows
from arcgym.anatomy.importing.openings import Opening, find_openings
from arcgym.anatomy.importing.orientation import Orientation, orient
from arcgym.anatomy.importing.path_search import LEAST_HOLE, FoundPath, find_path
from arcgym.anatomy.importing.placement import turned_grid
from arcgym.anatomy.importing.preflight import check_input
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.size_limits import check_filling
from arcgym.anatomy.importing.smooth_centerline import center_path
from arcgym.anatomy.importing.surfaces import fill_surface, load_surface
from arcgym.anatomy.importing.volumes import read_volume
from arcgym.anatomy.voxel_grid import Grid

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
    """One connected lumen from anus to cecum on voxels, in the patient's frame."""

    grid: Grid
    """The lumen, everything that is not colon cut off; axes right, anterior, cranial."""
    line: np.ndarray
    """Its centerline from the anal verge to the cecal pole, evenly spaced; straight in the canal [m], shape (n, 3)."""
    orientation: Orientation
    """How the file's axes lie in the patient."""
    openings: dict[str, CecalOpening] = field(default_factory=dict)
    """Ileocecal valve and appendix, where the scan shows them."""
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
    ends, end_source = anus_and_cecum(settings, openings)
    found, orientation = _find_path(grid, settings, source["kind"] == "surface", ends)
    points = found.points[::-1] if orientation.reversed else found.points
    cleaning.cut, cleaning.pouches = found.cut, found.pouches
    if found.filled_hole > LEAST_HOLE:
        cleaning.cut.append({"kind": "hole in the rectum, filled", "volume_ml": round(1e6 * found.filled_hole, 1)})
    rotation = FRAMES[orientation.frame]
    grid, points = turned_grid(grid, points, rotation)
    grid = Grid(gaussian_filter(grid.values, _SMOOTHING / grid.spacing), grid.origin, grid.spacing)
    line = center_path(grid, points, settings.cecum is None, [opening.turned(rotation) for opening in openings])
    progress.done("centerline", f"likeness {orientation.likeness:.2f}, frame {orientation.frame}")
    grid, line, canal = straighten_canal(grid, line)
    grid, windows = close_windows(grid, line)
    grid, widened = widen_for_head(grid, line, settings.min_lumen_radius)
    progress.done("passage", f"canal turned by {canal['turn_deg']:.0f} deg, {widened['share']:.0%} of the way widened")
    report: dict[str, Any] = {
        "input": {"file": path.name, **source},
        "cleaning": asdict(cleaning),
        "orientation": asdict(orientation),
        "anus": end_source,
        "canal": canal,
        "closed_short_cuts": found.closed,
        "lost_ml": round(1e6 * found.lost, 1),
        "windows": windows,
        "widened_for_head": widened,
        "volume_ml": round(1e6 * float(grid.mask.sum()) * grid.spacing**3, 1),
        "caliber_mm": round(2e3 * found.caliber, 1),
    }
    report["doubts"] = path_doubts(report)
    if not settings.keep_doubtful:
        refuse(report["doubts"])
    valves = cecal_openings(line, cleaning.cut, rotation)
    return Lumen(grid, line, orientation, valves, report)


def _read(path: Path, settings: ImportSettings) -> tuple[Grid, list[Opening], dict[str, str]]:
    """Return the lumen, where it is open if it was a surface, and what was read."""
    if path.name.lower().endswith(VOLUME_SUFFIXES):
        grid = read_volume(path, settings.label, settings.spacing, settings.voxel)
        return grid, [], {"kind": "volume", "units": "mm"}
    points, faces, unit = load_surface(path, settings.units, settings.spacing)
    grid = fill_surface(points, faces, settings.voxel)
    check_filling(grid.mask)
    return grid, find_openings(points, faces), {"kind": "surface", "units": unit}


def anus_and_cecum(settings: ImportSettings, openings: list[Opening]) -> tuple[list[np.ndarray | None], str]:
    """Return anus and cecal pole on the file's axes [m], None where they are to be found, and where the anus is from.

    An only opening of a surface is the anus, unless it lies where the caller says that the cecum is.
    """
    anus, cecum = (None if end is None else 1e-3 * np.array(end) for end in (settings.anus, settings.cecum))
    if anus is not None:
        return [anus, cecum], "given"
    if len(openings) == 1 and (
        cecum is None or np.linalg.norm(openings[0].center - cecum) > 2.0 * openings[0].radius + 0.02
    ):
        return [openings[0].center, cecum], "only opening"
    return [None, cecum], "found"


def _find_path(
    grid: Grid, settings: ImportSettings, is_surface: bool, ends: list[np.ndarray | None]
) -> tuple[FoundPath, Orientation]:
    """Return the path on the file's axes, and how these lie in the patient."""
    frame = settings.frame if is_surface else "ras"
    found = find_path(grid, ends, frame)
    return found, orient(found.points, frame, ends_known=any(end is not None for end in ends))
