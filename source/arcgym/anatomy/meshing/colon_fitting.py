# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From the surface of a lumen to everything of a colon's stage that is geometry; generator and importer share it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.meshing.coarse_wall import wall_points
from arcgym.anatomy.meshing.conformal_map import map_surface
from arcgym.anatomy.meshing.grid_surfaces import Detail, contact_surface, visual_surface
from arcgym.anatomy.meshing.lumen_grid import LumenGrid, fit_grid, ring_centers
from arcgym.anatomy.meshing.mending import mend_wall
from arcgym.anatomy.meshing.triangle_surface import TriangleSurface
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import Centerline, ContactSurface, VisualMesh, WallMesh

CENTERLINE_SPACING = 0.005
"""Distance of the points of a stage's centerline [m]."""

_RADIUS_SMOOTHING = 0.010
"""Standard deviation of the smoothing of the centerline's radius [m]."""


@dataclass(frozen=True)
class FitSettings:
    """How a lumen's surface becomes a colon."""

    shape: GridShape = field(default_factory=GridShape)
    """Numbers of rings, sectors, rows and columns. A batch can hold patients of one shape only."""
    thickness: float = 0.002
    """Thickness of the wall [m]."""
    least_radius: float = 0.0075
    """Least distance of the wall's inner vertices from the center of their ring [m]: a head has a radius of 6.6 mm."""
    lead: float = 0.020
    """Distance of the surface's first end in front of the anal verge along the centerline [m]; 0 if it ends there."""
    proxy_step: int = 2
    """Rows and columns of the grid for each of the surface drawn for policies; 2 is the contact surface's density."""


@dataclass(frozen=True)
class FittedColon:
    """Geometry of a stage."""

    grid: LumenGrid
    """Grid on the surface of the lumen."""
    wall: WallMesh
    """The wall."""
    contact: ContactSurface
    """What the scope touches."""
    visual: VisualMesh
    """Fine surface for videos."""
    visual_proxy: VisualMesh
    """Surface for policies' images."""
    centerline: Centerline
    """The given centerline, with the radius of the surface."""
    mended: float
    """Share of the wall's vertices that were moved by more than 1 mm to mend it."""


def fit_colon(
    surface: TriangleSurface,
    curve: Curve,
    settings: FitSettings | None = None,
    detail: Detail | None = None,
    refinements: int = 0,
    onto: Callable[[np.ndarray], np.ndarray] | None = None,
) -> FittedColon:
    """Make wall, contact and visual surfaces of a lumen.

    Args:
        surface: Closed surface of the lumen, one tube without side branches or windows between loops (handles of a
            voxel's size do no harm). It runs from :attr:`FitSettings.lead` in front of the anal verge to the pole.
        curve: Centerline inside of it from the anal verge to the cecal pole, with its segments.
        settings: Numbers of rings and rows, thickness, least radius.
        detail: Shapes finer than the grid, on the visual surfaces alone.
        refinements: How often the fine surface is refined near them; that for policies once at most.
        onto: Moves points that lie on the surface onto what it stands for, such as the field it was cut from; it takes
            and returns positions [m], shape (rows, columns, 3).

    Raises:
        ValueError: The ends are not those of a single tube, or no wall without inverted elements was found.
    """
    settings = settings or FitSettings()
    first = curve.position(np.array(0.0)) - settings.lead * curve.frame(np.array(0.0))[0]
    mapped = map_surface(surface, first, curve.position(np.array(curve.length)))
    grid = fit_grid(mapped, curve.points, settings.shape)
    if onto is not None:
        grid = replace(grid, points=onto(grid.points))
    layers, rows = wall_points(grid, settings.thickness)
    arc = np.interp(rows.mean(1), np.arange(grid.shape.rows), grid.arc[: grid.shape.rows])
    if detail and detail.touched:
        layers = layers + _shift(layers[0], detail.touched)
    mended = mend_wall(layers, settings.thickness, settings.least_radius)
    wall = build_wall(mended, curve.segment(arc), arc)
    bounds = {name: curve.bounds(name) for name in SEGMENTS}
    moved = np.linalg.norm(mended[0] - layers[0], axis=2) > 1e-3
    return FittedColon(
        grid=grid,
        wall=wall,
        contact=contact_surface(grid, rows, detail),
        visual=visual_surface(grid, rows, bounds, 1, detail, refinements),
        visual_proxy=visual_surface(grid, rows, bounds, settings.proxy_step, detail, min(refinements, 1)),
        centerline=_centerline(curve, grid),
        mended=float(moved.mean()),
    )


def _shift(points: np.ndarray, touched: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return by how much points are moved [m], shape kept."""
    flat = points.reshape(-1, 3)
    return (touched(flat) - flat).reshape(points.shape)


def _centerline(curve: Curve, grid: LumenGrid) -> Centerline:
    s = np.linspace(0.0, curve.length, round(curve.length / CENTERLINE_SPACING) + 1)
    radius = np.interp(s, grid.arc, ring_centers(grid.points)[1])
    tube = s <= grid.arc[grid.shape.rows - 1]
    radius = np.interp(s, s[tube], radius[tube])
    return Centerline(
        points=curve.position(s).astype(np.float32),
        arc=s.astype(np.float32),
        radius=gaussian_filter1d(radius, _RADIUS_SMOOTHING / CENTERLINE_SPACING, mode="nearest").astype(np.float32),
        segment=curve.segment(s),
    )
