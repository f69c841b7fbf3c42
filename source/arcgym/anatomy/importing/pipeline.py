# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Import a CT segmentation or a surface as a colon stage, stage by stage."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.importing.border_uncertainty import border_uncertainty
from arcgym.anatomy.importing.cecal_openings import VALVE
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import GRAVITY
from arcgym.anatomy.importing.lumen import Lumen, Progress, find_lumen
from arcgym.anatomy.importing.placement import describe_transform, given_landmarks
from arcgym.anatomy.importing.segment_borders import find_segment_ends
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.smooth_centerline import plain_curve
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.meshing.colon_fitting import FitSettings, FittedColon, fit_colon
from arcgym.anatomy.meshing.quantize import quantize, quantize_contact
from arcgym.anatomy.meshing.voxel_surface import voxel_surface
from arcgym.anatomy.mucosa.texture import write_textures
from arcgym.anatomy.stage.types import ColonStage, TissueMaterial
from arcgym.anatomy.voxel_grid import Grid

_CECUM = (0.03, 0.12)
"""Least and largest length of the cecum, from the valve's upper edge to the pole [m], at which a valve is believed."""


@dataclass(frozen=True)
class ImportedColon:
    """A stage, and what its report shows."""

    stage: ColonStage
    """The colon."""
    grid: Grid
    """The cleaned lumen in the patient's frame."""
    path: np.ndarray
    """Centerline in the patient's frame [m], shape (n, 3)."""
    rotation: np.ndarray
    """From the file's axes to the patient's, shape (3, 3)."""
    fitted: FittedColon
    """Wall and surfaces."""
    report: dict[str, Any] = field(default_factory=dict)
    """Figures by stage."""


def import_colon(path: Path, settings: ImportSettings, folder: Path) -> ImportedColon:
    """Import a colon.

    Args:
        path: Label volume or surface.
        settings: What the caller knows better.
        folder: Where the textures are written.

    Raises:
        ColonImportError: The input cannot become a colon; says what was found and what to pass.
    """
    progress = Progress()
    lumen = find_lumen(path, settings, progress)
    return mesh_colon(lumen, path.name, settings, folder, progress)


def mesh_colon(lumen: Lumen, source: str, settings: ImportSettings, folder: Path, progress: Progress) -> ImportedColon:
    """Make the rings, surfaces and landmarks of a lumen.

    Args:
        lumen: The lumen and the way through it.
        source: Name of the file it was read from.
        settings: What the caller knows better.
        folder: Where the textures are written.
        progress: Told when a stage is done.

    Raises:
        ColonImportError: No wall fits the lumen.
    """
    curve = plain_curve(lumen.line - lumen.line[0])
    given = given_landmarks(settings, plain_curve(lumen.line), lumen.rotation, curve.length)
    openings = _arcs(lumen, curve)
    given = _valve_border(lumen, openings, curve.length) | given
    ends, guessed = find_segment_ends(curve.points, curve.s, given)
    curve = Curve(curve.points, ends)
    fitted = _fit(lumen, curve, settings)
    progress.done("wall", f"{len(fitted.wall.points)} vertices, {100 * fitted.mended:.0f} % mended")
    transform = describe_transform(lumen.orientation, -lumen.line[0])
    folder.mkdir(parents=True, exist_ok=True)
    stage = _stage(source, curve, fitted, settings, folder, transform, openings)
    progress.done("surfaces", f"{len(stage.visual.points)} and {len(stage.visual_proxy.points)} vertices")
    uncertain = border_uncertainty(curve.points, curve.s, given)
    report = {
        **lumen.report,
        "guessed_landmarks": guessed,
        "landmark_uncertainty_mm": {name: None if name in guessed else _mm(value) for name, value in uncertain.items()},
        "seconds": progress.seconds,
    }
    return ImportedColon(stage, lumen.grid, lumen.line, lumen.rotation, fitted, report)


def _mm(value: float) -> float:
    return round(1e3 * value, 1)


def _fit(lumen: Lumen, curve: Curve, settings: ImportSettings) -> FittedColon:
    """Fit wall and surfaces to the lumen, the anal verge at the origin; what widening opened between loops is closed.

    Raises:
        ColonImportError: No wall fits.
    """
    fit = FitSettings(
        shape=GridShape(rings=settings.rings, sectors=settings.sectors),
        thickness=settings.wall_thickness,
        least_radius=settings.min_lumen_radius,
        lead=0.0,
    )
    grid = lumen.grid
    try:
        found = voxel_surface(grid.values, grid.origin - lumen.line[0], grid.spacing, curve.points)
        return fit_colon(found.surface, curve, fit)
    except ValueError as error:
        raise ColonImportError(str(error), "Check the segmentation there.") from error


def _arcs(lumen: Lumen, curve: Curve) -> dict[str, float]:
    """Return the arc length of valve and appendix on the stage's centerline [m]."""
    arcs = {}
    for name, opening in lumen.openings.items():
        nearest = np.linalg.norm(curve.points - (opening.position - lumen.line[0]), axis=1).argmin()
        arcs[name] = float(curve.s[nearest])
    return arcs


def _valve_border(lumen: Lumen, arcs: dict[str, float], length: float) -> dict[str, float]:
    """Return where the cecum begins [m]: at the upper edge of the valve, if that is where one may be."""
    if VALVE not in arcs:
        return {}
    edge = arcs[VALVE] - lumen.openings[VALVE].radius
    return {"cecum_entry": edge} if _CECUM[0] < length - edge < _CECUM[1] else {}


def _stage(
    source: str,
    curve: Curve,
    fitted: FittedColon,
    settings: ImportSettings,
    folder: Path,
    transform: dict[str, Any],
    openings: dict[str, float],
) -> ColonStage:
    albedo, detail = write_textures(folder, seed=sum(settings.name.encode()))
    return ColonStage(
        name=settings.name,
        wall=fitted.wall,
        visual=quantize(fitted.visual),
        visual_proxy=quantize(fitted.visual_proxy),
        centerline=fitted.centerline,
        landmarks=find_landmarks(curve, openings),
        material=TissueMaterial(),
        albedo_texture=albedo,
        detail_texture=detail,
        metadata={
            "patient": settings.patient,
            "posture": settings.posture,
            "gravityInScan": GRAVITY[settings.posture],
            "provenance": f"imported from {source} with arcgym import-colon",
            "licence": settings.licence,
            **transform,
        },
        contact=quantize_contact(fitted.contact),
    )
