# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From a CT segmentation or a surface to a colon stage, step by step."""

from __future__ import annotations

import logging
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.texture import write_textures
from arcgym.anatomy.importing.centerline import LEAST_HOLE, find_path
from arcgym.anatomy.importing.cleaning import keep_colon
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import FRAMES, GRAVITY, VOLUME_SUFFIXES
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.landmarks import find_segment_ends
from arcgym.anatomy.importing.openings import Opening, find_openings
from arcgym.anatomy.importing.orientation import Orientation, orient
from arcgym.anatomy.importing.polar import cast, cast_rings, own_loop
from arcgym.anatomy.importing.preflight import check_input
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.smooth_centerline import centerd, plain_curve, relaxed, with_upright_canal
from arcgym.anatomy.importing.surfaces import fill_surface, load_surface
from arcgym.anatomy.importing.visual_fitting import fit_visual
from arcgym.anatomy.importing.volumes import read_volume
from arcgym.anatomy.importing.wall_fitting import FittedWall, fit_wall
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.stage.types import Centerline, ColonStage, TissueMaterial

_LOGGER = logging.getLogger(__name__)
_MEASURE_SPACING = 0.001
_MEASURE_COLUMNS = 72
_SMOOTHING = 0.0006
_DOME_ROWS = 12
_FARTHEST_LANDMARK = 0.06


@dataclass(frozen=True)
class Measured:
    """Centreline and radii in the patient's frame."""

    curve: Curve
    """Centreline."""
    s: np.ndarray
    """Arc length of the cross-sections [m], shape (n,)."""
    radius: np.ndarray
    """Distance to the wall [m], shape (n, k)."""
    dome_row: int
    """Cross-section at which the dome of the caecum begins."""
    dome: np.ndarray
    """Distance to the wall from its centre, from across the curve to along it [m], shape (m, k)."""


@dataclass(frozen=True)
class ImportedColon:
    """A stage with what an import has to tell about it."""

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

    def done(self, stage: str, told: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = round(now - self._start, 2)
        self._start = now
        _LOGGER.info("%-11s %5.1f s  %s", stage, self.seconds[stage], told)


def import_colon(path: Path, settings: ImportSettings, folder: Path) -> ImportedColon:
    """Imports a colon.

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
    course, orientation, cleaning.cut = _course(grid, settings, source["kind"] == "surface")
    rotation = FRAMES[orientation.frame]
    grid, course = _turned(grid, course, rotation)
    progress.done("centreline", f"likeness {orientation.likeness:.2f}, frame {orientation.frame}")
    grid = Grid(gaussian_filter(grid.values, _SMOOTHING / grid.spacing), grid.origin, grid.spacing)
    measured = _measure(grid, course, settings, [opening.turned(rotation) for opening in openings])
    progress.done("radii", f"{1e3 * measured.curve.length:.0f} mm long")
    curve, measured, canal = _placed(measured)
    given = _given_landmarks(settings, measured.curve, rotation, curve.length)
    ends, guessed = find_segment_ends(curve.points, curve.s, given)
    curve = Curve(curve.points, ends)
    fitted = fit_wall(curve, measured.s, measured.radius, settings)
    progress.done("wall", f"{len(fitted.wall.points)} vertices, {100 * fitted.widened:.0f} % widened")
    transform = _transform(orientation, measured, curve, canal)
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
    """Returns the lumen, where it is open if it was a surface, and what was read."""
    if path.name.lower().endswith(VOLUME_SUFFIXES):
        grid = read_volume(path, settings.label, settings.spacing, settings.voxel)
        return grid, [], {"kind": "volume", "units": "mm"}
    points, faces, unit = load_surface(path, settings.units, settings.spacing)
    grid = fill_surface(points, faces, settings.voxel)
    return grid, find_openings(points, faces), {"kind": "surface", "units": unit}


def _course(grid: Grid, settings: ImportSettings, is_surface: bool) -> tuple[np.ndarray, Orientation, list[Any]]:
    """Returns the way from anus to caecum in the file's axes, how these lie in the patient, and what was cut off."""
    ends = [None if end is None else 1e-3 * np.array(end) for end in (settings.anus, settings.cecum)]
    frame = settings.frame if is_surface else "ras"
    found = find_path(grid, ends, frame)
    orientation = orient(found.points, frame, ends_known=any(end is not None for end in ends))
    if found.filled_hole > LEAST_HOLE:
        found.cut.append({"kind": "hole in the rectum, filled", "volume_ml": round(1e6 * found.filled_hole, 1)})
    return (found.points[::-1] if orientation.reversed else found.points), orientation, found.cut


def _turned(grid: Grid, course: np.ndarray, rotation: np.ndarray) -> tuple[Grid, np.ndarray]:
    """Turns a grid and a course by a rotation that maps axes onto axes."""
    axes = np.abs(rotation).argmax(1)
    signs = rotation[np.arange(3), axes]
    values, origin = grid.values.transpose(axes), signs * grid.origin[axes]
    for axis in np.flatnonzero(signs < 0):
        values = np.flip(values, int(axis))
        origin[axis] -= (values.shape[axis] - 1) * grid.spacing
    return Grid(np.ascontiguousarray(values), origin, grid.spacing), course @ rotation.T


def _measure(grid: Grid, course: np.ndarray, settings: ImportSettings, openings: list[Opening]) -> Measured:
    points = centerd(grid, course, settings.cecum is None, openings)
    half_width = settings.min_lumen_radius + settings.wall_thickness + 0.5 * settings.clearance
    curve = plain_curve(relaxed(points, np.full(len(points), half_width)))
    s = np.linspace(0.0, curve.length, round(curve.length / _MEASURE_SPACING) + 1)
    radius = own_loop(curve, s, cast_rings(grid, curve, s, _MEASURE_COLUMNS))
    reach = np.clip(np.median(radius[-60:-20]), 0.012, 0.035)
    row = int(np.searchsorted(s, curve.length - reach))
    theta = np.arange(_MEASURE_COLUMNS) * 2 * np.pi / _MEASURE_COLUMNS
    tangent, normal, binormal = curve.frame(s[row])
    flat = np.cos(theta)[:, None] * normal + np.sin(theta)[:, None] * binormal
    lift = np.linspace(0.0, 0.5 * np.pi, _DOME_ROWS)[:, None, None]
    ways = np.cos(lift) * flat + np.sin(lift) * tangent
    centers = np.repeat(curve.position(s[row])[None], _DOME_ROWS, 0)
    dome = np.minimum(cast(grid, centers, ways), 1.6 * reach)
    return Measured(curve, s, radius, row, dome)


def _placed(measured: Measured) -> tuple[Curve, Measured, float]:
    """Returns the curve in the stage's frame, what was measured in its frames, and the turn of the canal [rad]."""
    old = measured.curve
    points, angle = with_upright_canal(old.points)
    curve = plain_curve(points)
    at = np.array(0.5 * curve.length)
    _, normal, binormal = old.frame(at)
    turned = curve.frame(at)[1]
    columns = measured.radius.shape[1]
    turn = np.arctan2(turned @ binormal, turned @ normal) * columns / (2 * np.pi)
    radius, dome = (_rolled(values, float(turn)) for values in (measured.radius, measured.dome))
    s = measured.s * curve.length / old.length
    return curve, Measured(old, s, radius, measured.dome_row, dome), angle


def _rolled(values: np.ndarray, columns: float) -> np.ndarray:
    """Shifts columns round by a fraction, shape kept."""
    whole = int(np.floor(columns))
    share = columns - whole
    return (1 - share) * np.roll(values, -whole, 1) + share * np.roll(values, -whole - 1, 1)


def _given_landmarks(settings: ImportSettings, curve: Curve, rotation: np.ndarray, length: float) -> dict[str, float]:
    """Returns the arc length [m] of the landmarks that the caller knows, of positions the nearest."""
    arcs = {}
    for name, place in settings.landmarks.items():
        if isinstance(place, float | int):
            arcs[name] = float(place)
            continue
        distance = np.linalg.norm(curve.points - 1e-3 * np.array(place) @ rotation.T, axis=1)
        if distance.min() > _FARTHEST_LANDMARK:
            raise ColonImportError(
                f"The landmark {name} at {place} mm is {1e3 * distance.min():.0f} mm away from the centreline",
                "Pass --landmark NAME=X,Y,Z in millimetres on the same axes as --anus.",
            )
        arcs[name] = float(curve.s[distance.argmin()]) * length / curve.length
    return arcs


def _transform(orientation: Orientation, measured: Measured, curve: Curve, canal: float) -> dict[str, Any]:
    """Describes how the file's coordinates became the stage's."""
    half = np.array(0.5 * curve.length)
    offset = curve.position(half) - measured.curve.position(half * measured.curve.length / curve.length)
    return {
        "sourceFrame": orientation.frame,
        "rotationFromSource": FRAMES[orientation.frame].ravel().tolist(),
        "translationAfterRotation": [round(float(value), 6) for value in offset],
        "canalTurnedDegrees": round(float(np.degrees(canal)), 1),
        "transformNote": "stage = rotation * source [m] + translation; the first 7 cm are bent so that the canal is +Z",
    }


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
        centerline=_centerline(curve, measured),
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


def _centerline(curve: Curve, measured: Measured, spacing: float = 0.005) -> Centerline:
    s = np.linspace(0.0, curve.length, round(curve.length / spacing) + 1)
    mean = gaussian_filter1d(measured.radius.mean(1), 10.0, mode="nearest")
    return Centerline(
        points=curve.position(s).astype(np.float32),
        arc=s.astype(np.float32),
        radius=np.interp(s, measured.s, mean).astype(np.float32),
        segment=curve.segment(s),
    )
