# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From a surface to a grid and a wall: a straight tube, whose map is known, and a bend that folds."""

from __future__ import annotations

import numpy as np
import pytest
from folded_bend import centerline, field
from scipy.spatial import cKDTree

from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.measures import tet_quality
from arcgym.anatomy.meshing.coarse_wall import RING_DISTANCE, place_rings, wall_points
from arcgym.anatomy.meshing.conformal_map import ConformalMap, map_surface
from arcgym.anatomy.meshing.level_curves import level_rings
from arcgym.anatomy.meshing.lumen_grid import LumenGrid, fit_grid, ring_centers
from arcgym.anatomy.meshing.triangle_surface import TriangleSurface, cut_surface
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.validation.mesh_checks import boundary_faces, count_crossings

SHAPE = GridShape(rings=14)


@pytest.fixture(scope="module")
def line() -> np.ndarray:
    return centerline()


@pytest.fixture(scope="module")
def surface(line: np.ndarray) -> TriangleSurface:
    values, low = field(line)
    return cut_surface(values, low, 0.00125)


@pytest.fixture(scope="module")
def mapped(surface: TriangleSurface, line: np.ndarray) -> ConformalMap:
    return map_surface(surface, line[0] - [0, 0.016, 0], line[-1] + 16 * 2 * (line[-1] - line[-2]))


@pytest.fixture(scope="module")
def grid(mapped: ConformalMap, line: np.ndarray) -> LumenGrid:
    return fit_grid(mapped, line, SHAPE)


@pytest.fixture(scope="module")
def tube() -> tuple[ConformalMap, np.ndarray]:
    """A straight closed tube of radius 10 mm and length 80 mm along y."""
    way = np.array([[0, 0, 0], [0, 0.08, 0]])
    values, low = field(np.linspace(*way, 161), radius=0.010, fold=0.0, spacing=0.001)
    return map_surface(cut_surface(values, low, 0.001), way[0] - [0, 0.01, 0], way[1] + [0, 0.01, 0]), way


def test_map_of_a_straight_tube(tube: tuple[ConformalMap, np.ndarray]) -> None:
    """Between the domes u rises evenly, and v is the angle: along y by du for every 2 pi r dv / (circumference)."""
    mapped, _ = tube
    middle = (mapped.points[:, 1] > 0.01) & (mapped.points[:, 1] < 0.07)
    x, y, z = mapped.points[middle].T
    slope, start = np.polyfit(y, mapped.u[middle], 1)
    assert np.abs(mapped.u[middle] - slope * y - start).max() < 0.01
    turn = np.unwrap(mapped.v[middle][np.argsort(np.arctan2(z, x))])
    angle = np.sort(np.arctan2(z, x))
    sign = np.sign(np.polyfit(angle, turn, 1)[0])
    assert np.polyfit(angle, turn, 1)[0] == pytest.approx(sign, rel=0.02)
    assert np.abs(np.exp(1j * (turn - sign * angle)) - np.exp(1j * (turn - sign * angle)).mean()).max() < 0.1


def test_rings_of_a_straight_tube_are_circles(tube: tuple[ConformalMap, np.ndarray]) -> None:
    mapped, _ = tube
    rings, angle, found = level_rings(mapped, np.array([0.4, 0.5, 0.6]), 24)
    center, radius = ring_centers(rings)
    assert found.all()
    assert radius == pytest.approx(0.010, abs=1e-4)
    assert np.abs(angle - np.arange(24) * np.pi / 12).max() < 0.1, "on a circle v and length agree"
    assert np.ptp(rings[..., 1], axis=1).max() < 1.2e-3, "the caps are a voxel off the axis, which tilts the curves"
    assert center[1] == pytest.approx([0, 0.04, 0], abs=3e-4)


def test_rings_take_the_wide_way_where_the_cut_takes_a_hole() -> None:
    """A plate across a tube of 10 mm radius has a wide hole at one side and one of 2 mm radius at the other.

    The shortest path along the surface goes through the small one; the rings go through the wide one.
    """
    low, count = np.array([-0.013, -0.013, -0.013]), (27, 107, 27)
    x, y, z = np.moveaxis(low + 0.001 * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), -1), -1, 0)
    tube = np.minimum(0.010 - np.hypot(x, z), np.minimum(y + 0.010, 0.090 - y))
    plate = 0.0015 - np.abs(y - 0.040)
    holes = np.maximum(0.005 - np.hypot(x + 0.004, z), 0.002 - np.hypot(x - 0.0065, z))
    surface = cut_surface(np.minimum(tube, np.maximum(-plate, holes)), low, 0.001)
    mapped = map_surface(surface, np.array([0.0095, 0.0, 0.0]), np.array([0.0095, 0.08, 0.0]))
    at_plate = mapped.points[mapped.cut][np.abs(mapped.points[mapped.cut][:, 1] - 0.040) < 0.001]
    assert (at_plate[:, 0] > 0.004).all(), "the cut goes through the small hole"
    u = mapped.u[np.abs(mapped.points[:, 1] - 0.040) < 0.0008]
    rings, angle, found = level_rings(mapped, np.linspace(u.min(), u.max(), 7)[1:-1], 36)
    center, radius = ring_centers(rings)
    assert found.all() and (radius > 0.004).all()
    assert (np.diff(angle, axis=1) > 0).all()
    assert np.linalg.norm(np.diff(rings, axis=0), axis=2).max() < 0.006, "neighboring rings fit each other"


def test_grid_begins_at_the_verge_and_ends_at_the_pole(tube: tuple[ConformalMap, np.ndarray]) -> None:
    mapped, way = tube
    grid = fit_grid(mapped, way, GridShape(rings=8))
    assert grid.points.shape == (7 * 6 + 1 + 12, 84, 3)
    assert grid.arc[0] == pytest.approx(0.0, abs=1e-3) and grid.arc[-1] == pytest.approx(0.08, abs=1e-6)
    assert (np.diff(grid.arc) > 0).all()
    assert np.abs(grid.points[0, :, 1]).max() < 1e-3
    assert np.ptp(grid.points[-1], axis=0).max() == 0.0
    assert grid.points[-1, 0, 1] > 0.085


def test_columns_turn_right_handed_about_the_way_ahead(tube: tuple[ConformalMap, np.ndarray]) -> None:
    mapped, way = tube
    ring = fit_grid(mapped, way, GridShape(rings=8)).points[20]
    spoke = ring - ring.mean(0)
    assert np.cross(spoke[0], spoke[1])[1] > 0


def test_grid_follows_a_bend_that_folds(grid: LumenGrid, surface: TriangleSurface) -> None:
    """The grid's points lie on the surface; from the surface the grid is within 1.6 mm at the 95th percentile."""
    on = cKDTree(surface.points).query(grid.points.reshape(-1, 3))[0]
    assert np.percentile(on, 95) < 0.001
    inside = surface.points[surface.points[:, 1] > 0.0]
    fine = grid.points
    middle = 0.25 * (fine[1:] + fine[:-1] + np.roll(fine[1:], -1, 1) + np.roll(fine[:-1], -1, 1))
    dense = np.concatenate([fine.reshape(-1, 3), middle.reshape(-1, 3)])
    off = cKDTree(dense).query(inside)[0]
    assert np.percentile(off, 95) < 0.0016


def test_rows_come_near_at_the_crease_but_never_meet(grid: LumenGrid) -> None:
    step = np.linalg.norm(np.diff(grid.tube, axis=0), axis=2)
    assert step.min() > 1e-4
    assert step.min() < 0.5 * np.median(step)


def test_wall_of_a_folded_bend(grid: LumenGrid) -> None:
    layers, rows = wall_points(grid, 0.002)
    arc = np.interp(rows.mean(1), np.arange(SHAPE.rows), grid.arc[: SHAPE.rows])
    wall = build_wall(layers, np.zeros(SHAPE.rings, int), arc)
    assert tet_quality(wall.points, wall.tets).min() > 0.06
    assert np.linalg.norm(np.diff(layers[1], axis=0), axis=2).min() > 0.003
    assert count_crossings(wall.points, boundary_faces(wall.tets)) == 0


def test_rings_slide_apart_by_the_least_way() -> None:
    """Rows 1 mm apart along a line but 0.1 mm in its middle: rings a few rows apart there move out to the distance."""
    step = np.r_[np.full(20, 0.001), np.full(10, 0.0001), np.full(20, 0.001)]
    points = np.zeros((51, 3, 3))
    points[..., 1] = np.r_[0.0, np.cumsum(step)][:, None]
    rows = place_rings(points, np.tile([1.0, 0.0, 0.0], (51, 3, 1)), 11, 0.002)
    place = np.interp(rows[:, 0], np.arange(51), points[:, 0, 1])
    assert place[0] == 0.0 and place[-1] == pytest.approx(points[-1, 0, 1])
    assert np.diff(place).min() > 0.99 * RING_DISTANCE
    assert place[1] == pytest.approx(0.005, abs=0.0005)


def test_lumen_that_leaves_the_grid_is_named() -> None:
    with pytest.raises(ValueError, match="must lie inside the grid"):
        cut_surface(np.ones((4, 4, 4)), np.zeros(3), 0.001)


def test_ends_that_coincide_are_named(surface: TriangleSurface, line: np.ndarray) -> None:
    with pytest.raises(ValueError, match="ends of the lumen are 0.0 mm apart"):
        map_surface(surface, line[0], line[0])
