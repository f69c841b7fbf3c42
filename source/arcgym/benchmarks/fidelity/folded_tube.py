# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tube whose bend is tighter than its lumen is wide, with the grid of the shipped colons."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy import ColonStage, segment_index, write_colon
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.meshing.colon_fitting import FitSettings, fit_colon
from arcgym.anatomy.meshing.triangle_surface import TriangleSurface, cut_surface
from arcgym.anatomy.segments import SEGMENTS
from arcgym.benchmarks.fidelity.tubes import HELD_SPACINGS, SEGMENT, Tube, hold, shipped_stage, wall_measures

SHARE = 0.9
"""Radius of the bend over that of the lumen: one bend in twenty of real colons has 0.85 to 1.0 (docs/patients.md)."""
TURN, START, BEYOND = math.radians(100.0), 0.14, 0.18
"""Angle of the bend [rad], length of the tube before and behind it [m]."""
_STEP, _VOXEL = 0.0005, 0.00125


def folded_tube() -> Tube:
    """Return the course: straight, the bend towards +Y, straight; with the lumen of the shipped sigmoid."""
    radius = wall_measures().radius
    bend = SHARE * radius
    return Tube(START + TURN * bend + BEYOND, TURN, START, bend, radius=radius)


def write_folded(folder: Path) -> Path:
    """Write the tube into a folder of its own within ``folder``, once, and return its stage."""
    path = folder / "folded_tube" / "colon.usda"
    return path if path.exists() else write_colon(folded_stage(folded_tube()), path)


def folded_stage(tube: Tube) -> ColonStage:
    """Return a tube made as colons are: its lumen as a field, the field's surface mapped to the grid of rings.

    Args:
        tube: Its course; rings across it may cross, which a stage of :func:`tube_stage` must not.
    """
    assert tube.radius is not None
    measures, shipped = wall_measures(), shipped_stage()
    line = tube.frame(np.arange(0.0, tube.length, _STEP))[0]
    pole = line[-1] + 0.97 * tube.radius * (line[-1] - line[-2]) / _STEP
    curve = Curve(np.concatenate([line, [pole]])[:: round(0.004 / _STEP)], np.arange(1.0, 1.0 + len(SEGMENTS)))
    rings = round(tube.length / measures.spacing) + 1
    shape = GridShape(rings=rings, sectors=measures.sectors)
    settings = FitSettings(shape=shape, thickness=measures.thickness, lead=tube.radius)
    fitted = fit_colon(_surface(line, tube.radius), curve, settings)
    code = segment_index(SEGMENT)
    wall = replace(fitted.wall, segment=np.full_like(fitted.wall.segment, code))
    line_codes = np.full_like(fitted.centerline.segment, code)
    ends = (HELD_SPACINGS[0] * measures.spacing, float(wall.ring_arc[-1]) - HELD_SPACINGS[1] * measures.spacing)
    return ColonStage(
        name="folded_tube",
        wall=hold(wall, *ends),
        visual=fitted.visual,
        visual_proxy=fitted.visual_proxy,
        centerline=replace(fitted.centerline, segment=line_codes),
        landmarks={"anal_verge": 0.0, "blind_end": curve.length},
        material=shipped.material,
        albedo_texture=shipped.albedo_texture,
        detail_texture=shipped.detail_texture,
        metadata={"provenance": "arcgym bench fidelity", "licence": "BSD-3-Clause", "patient": "none"},
        contact=fitted.contact,
    )


def _surface(line: np.ndarray, radius: float) -> TriangleSurface:
    """Return the surface at a distance from a line [m], closed by half balls."""
    low = line.min(0) - radius - 4.0 * _VOXEL
    count = np.ceil((np.ptp(line, axis=0) + 2.0 * radius + 8.0 * _VOXEL) / _VOXEL).astype(int)
    at = np.moveaxis(np.indices(count), 0, -1).reshape(-1, 3) * _VOXEL + low
    return cut_surface((radius - cKDTree(line).query(at)[0]).reshape(count), low, _VOXEL)
