# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Import a CT segmentation or a surface as a colon stage, stage by stage."""

from __future__ import annotations

import logging
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.cleaning import keep_colon
from arcgym.anatomy.importing.formats import FRAMES, GRAVITY, VOLUME_SUFFIXES
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.measuring import Measured, measure, sample_centerline
from arcgym.anatomy.importing.openings import Opening, find_openings
from arcgym.anatomy.importing.orientation import Orientation, orient
from arcgym.anatomy.importing.path_search import LEAST_HOLE, find_path
from arcgym.anatomy.importing.placement import describe_transform, given_landmarks, place, turned_grid
from arcgym.anatomy.importing.preflight import check_input
from arcgym.anatomy.importing.segment_borders import find_segment_ends
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.surfaces import fill_surface, load_surface
from arcgym.anatomy.importing.visual_fitting import fit_visual
from arcgym.anatomy.importing.volumes import read_volume
from arcgym.anatomy.importing.wall_fitting import FittedWall, fit_wall
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.mucosa.texture import write_textures
from arcgym.anatomy.stage.types import ColonStage, TissueMaterial

_LOGGER = logging.getLogger(__name__)
_SMOOTHING = 0.0006
"""Standard deviation of the smoothing of the lumen before it is measured [m]."""


@dataclass(frozen=True)
class ImportedColon:
    """A stage, and what its report shows."""

    stage: ColonStage
    """The colon."""
    grid: Grid
    """The cleaned lumen in the patient's frame."""
    path: np.ndarray
    """Centreline in the patient's frame [m], shape (n, 3)."""
    rotation: np.ndarray
    """From the file's axes to the patient's, shape (3, 3)."""
    fitted: FittedWall
    """The wall and how it differs from the measured surface."""
    report: dict[str, Any] = field(default_factory=dict)
    """Figures by stage."""


class _Progress:
    """Logs and times the stages of an import."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._start = time.perf_counter()

    def done(self, stage: str, message: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = round(now - self._start, 2)
        self._start = now
        _LOGGER.info("%-11s %5.1f s  %s", stage, self.seconds[stage], message)


def import_colon(path: Path, settings: ImportSettings, folder: Path) -> ImportedColon:
    """Import a colon.

    Args:
        path: Label volume or surface.
        settings: What the caller knows better.
        folder: Where the textures are written.

    Raises:
        ColonImportError: The input cannot become a colon; says what was found and what to pass.
    """
    check_input(path)
    progress = _Progress()
    grid, openings, source = _read(path, settings)
    progress.done("read", f"{grid.mask.sum() * grid.spacing**3 * 1e6:.0f} ml in {'x'.join(map(str, grid.mask.shape))}")
    grid, cleaning = keep_colon(grid, settings.max_gap)
    progress.done(
        "clean", f"{cleaning.pieces} pieces, {len(cleaning.bridges)} bridged, {len(cleaning.dropped)} dropped"
    )
    path_points, orientation, cleaning.cut = _find_path(grid, settings, source["kind"] == "surface")
    rotation = FRAMES[orientation.frame]
    grid, path_points = turned_grid(grid, path_points, rotation)
    progress.done("centreline", f"likeness {orientation.likeness:.2f}, frame {orientation.frame}")
    grid = Grid(gaussian_filter(grid.values, _SMOOTHING / grid.spacing), grid.origin, grid.spacing)
    measured = measure(grid, path_points, settings, [opening.turned(rotation) for opening in openings])
    progress.done("radii", f"{1e3 * measured.curve.length:.0f} mm long")
    curve, measured, canal = place(measured)
    given = given_landmarks(settings, measured.curve, rotation, curve.length)
    ends, guessed = find_segment_ends(curve.points, curve.s, given)
    curve = Curve(curve.points, ends)
    fitted = fit_wall(curve, measured.s, measured.radius, settings)
    progress.done("wall", f"{len(fitted.wall.points)} vertices, {100 * fitted.widened:.0f} % widened")
    transform = describe_transform(orientation, measured, curve, canal)
    folder.mkdir(parents=True, exist_ok=True)
    stage = _stage(path, curve, measured, fitted, settings, folder, transform)
    progress.done("surfaces", f"{len(stage.visual.points)} and {len(stage.visual_proxy.points)} vertices")
    report = {
        "input": {"file": path.name, **source},
        "cleaning": asdict(cleaning),
        "orientation": asdict(orientation),
        "guessed_landmarks": guessed,
        "seconds": progress.seconds,
    }
    return ImportedColon(stage, grid, measured.curve.points, rotation, fitted, report)


def _read(path: Path, settings: ImportSettings) -> tuple[Grid, list[Opening], dict[str, str]]:
    """Return the lumen, where it is open if it was a surface, and what was read."""
    if path.name.lower().endswith(VOLUME_SUFFIXES):
        grid = read_volume(path, settings.label, settings.spacing, settings.voxel)
        return grid, [], {"kind": "volume", "units": "mm"}
    points, faces, unit = load_surface(path, settings.units, settings.spacing)
    grid = fill_surface(points, faces, settings.voxel)
    return grid, find_openings(points, faces), {"kind": "surface", "units": unit}


def _find_path(grid: Grid, settings: ImportSettings, is_surface: bool) -> tuple[np.ndarray, Orientation, list[Any]]:
    """Return the path from anus to cecum on the file's axes, how these lie in the patient, and what was cut off."""
    ends = [None if end is None else 1e-3 * np.array(end) for end in (settings.anus, settings.cecum)]
    frame = settings.frame if is_surface else "ras"
    found = find_path(grid, ends, frame)
    orientation = orient(found.points, frame, ends_known=any(end is not None for end in ends))
    if found.filled_hole > LEAST_HOLE:
        found.cut.append({"kind": "hole in the rectum, filled", "volume_ml": round(1e6 * found.filled_hole, 1)})
    return (found.points[::-1] if orientation.reversed else found.points), orientation, found.cut


def _stage(
    path: Path,
    curve: Curve,
    measured: Measured,
    fitted: FittedWall,
    settings: ImportSettings,
    folder: Path,
    transform: dict[str, Any],
) -> ColonStage:
    albedo, detail = write_textures(folder, seed=sum(settings.name.encode()))
    row = measured.dome_row + 1
    shape = (curve, measured.s[:row], measured.radius[:row], measured.dome, fitted)
    return ColonStage(
        name=settings.name,
        wall=fitted.wall,
        visual=fit_visual(*shape, settings.visual_spacing, settings.visual_columns),
        visual_proxy=fit_visual(*shape, settings.proxy_spacing, settings.proxy_columns),
        centerline=sample_centerline(curve, measured),
        landmarks=find_landmarks(curve),
        material=TissueMaterial(),
        albedo_texture=albedo,
        detail_texture=detail,
        metadata={
            "patient": settings.patient,
            "posture": settings.posture,
            "gravityInScan": GRAVITY[settings.posture],
            "provenance": f"imported from {path.name} with arcgym import-colon",
            "licence": settings.licence,
            **transform,
        },
    )
