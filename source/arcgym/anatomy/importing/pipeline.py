# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Import a CT segmentation or a surface as a colon stage, stage by stage."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.border_uncertainty import border_uncertainty
from arcgym.anatomy.importing.cecal_openings import VALVE
from arcgym.anatomy.importing.formats import GRAVITY
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.lumen import Lumen, Progress, find_lumen
from arcgym.anatomy.importing.measuring import Measured, measure, sample_centerline
from arcgym.anatomy.importing.placement import describe_transform, given_landmarks, place
from arcgym.anatomy.importing.segment_borders import find_segment_ends
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.visual_fitting import fit_visual
from arcgym.anatomy.importing.wall_fitting import FittedWall, fit_wall
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.mucosa.texture import write_textures
from arcgym.anatomy.stage.types import ColonStage, TissueMaterial

_CECUM = (0.03, 0.12)
"""Least and largest length of the caecum, from the valve's upper edge to the pole [m], at which a valve is believed."""


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
    measured = measure(lumen.grid, lumen.line, settings)
    progress.done("radii", f"{1e3 * measured.curve.length:.0f} mm long")
    curve, measured, canal = place(measured)
    given = given_landmarks(settings, measured.curve, lumen.rotation, curve.length)
    openings = _arcs(lumen, measured.curve, curve.length)
    given = _valve_border(lumen, openings, curve.length) | given
    ends, guessed = find_segment_ends(curve.points, curve.s, given)
    curve = Curve(curve.points, ends)
    fitted = fit_wall(curve, measured.s, measured.radius, settings)
    progress.done("wall", f"{len(fitted.wall.points)} vertices, {100 * fitted.widened:.0f} % widened")
    transform = describe_transform(lumen.orientation, measured, curve, canal)
    folder.mkdir(parents=True, exist_ok=True)
    stage = _stage(source, curve, measured, fitted, settings, folder, transform, openings)
    progress.done("surfaces", f"{len(stage.visual.points)} and {len(stage.visual_proxy.points)} vertices")
    uncertain = border_uncertainty(curve.points, curve.s, given)
    report = {
        **lumen.report,
        "guessed_landmarks": guessed,
        "landmark_uncertainty_mm": {name: None if name in guessed else _mm(value) for name, value in uncertain.items()},
        "seconds": progress.seconds,
    }
    return ImportedColon(stage, lumen.grid, measured.curve.points, lumen.rotation, fitted, report)


def _mm(value: float) -> float:
    return round(1e3 * value, 1)


def _arcs(lumen: Lumen, curve: Curve, length: float) -> dict[str, float]:
    """Return the arc length of valve and appendix on the stage's centreline [m]."""
    arcs = {}
    for name, opening in lumen.openings.items():
        nearest = np.linalg.norm(curve.points - opening.position, axis=1).argmin()
        arcs[name] = float(curve.s[nearest]) * length / curve.length
    return arcs


def _valve_border(lumen: Lumen, arcs: dict[str, float], length: float) -> dict[str, float]:
    """Return where the caecum begins [m]: at the upper edge of the valve, if that is where one may be."""
    if VALVE not in arcs:
        return {}
    edge = arcs[VALVE] - lumen.openings[VALVE].radius
    return {"cecum_entry": edge} if _CECUM[0] < length - edge < _CECUM[1] else {}


def _stage(
    source: str,
    curve: Curve,
    measured: Measured,
    fitted: FittedWall,
    settings: ImportSettings,
    folder: Path,
    transform: dict[str, Any],
    openings: dict[str, float],
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
    )
