# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces that are open: where their rims are, and that the centerline begins in the middle of the rim."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from label_volumes import RADIUS, course, write_volume
from skimage.measure import marching_cubes
from test_surfaces import LENGTH, cylinder
from test_surfaces import RADIUS as WIDE

from arcgym.anatomy.importing.openings import Opening, find_openings, lead_to_opening
from arcgym.anatomy.importing.path_search import find_path
from arcgym.anatomy.importing.smooth_centerline import center_path
from arcgym.anatomy.importing.surfaces import fill_surface
from arcgym.anatomy.importing.volumes import read_volume

VOXEL = 0.002


def test_rim_of_a_cylinder() -> None:
    (opening,) = find_openings(*cylinder(open_end=True))
    assert opening.center == pytest.approx([0.0, 0.0, 0.5 * LENGTH], abs=1e-6)
    assert opening.radius == pytest.approx(WIDE, rel=0.01)
    assert find_openings(*cylinder(open_end=False)) == []


def test_triangles_that_share_no_vertices_have_the_same_rim() -> None:
    """As in an STL file."""
    points, faces = cylinder(open_end=True)
    loose = points[faces].reshape(-1, 3)
    (opening,) = find_openings(loose, np.arange(len(loose)).reshape(-1, 3))
    assert opening.radius == pytest.approx(WIDE, rel=0.01)


def test_path_into_a_corner_is_led_to_the_middle() -> None:
    """It runs up to 3 cm before the end, then aside; it goes straight on from where the rim is a radius away."""
    path = np.array([(0.0, 0.0, z) for z in np.arange(0.0, 0.071, 0.002)] + [(0.01, 0.0, 0.08), (0.015, 0.0, 0.095)])
    led = lead_to_opening(path, [Opening(np.array([0.0, 0.0, 0.1]), 0.020)])
    assert led is not None
    assert led[-1] == pytest.approx([0.0, 0.0, 0.1])
    assert lead_to_opening(path, [Opening(np.array([0.0, 0.0, 0.01]), 0.020)]) is None


def opened(tmp_path: Path, s: float, normal: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the tube without what lies within 10 cm of its start and behind a plane at an arc length."""
    grid = read_volume(write_volume(tmp_path / "tube.mha"), None, None, 0.003)
    points, faces, *_ = marching_cubes(grid.values, 0.5)
    points = grid.points(points)
    line, _ = course()
    corners = points[faces]
    behind = ((corners - line[round(s / 0.002)]) @ normal).min(1) < 0
    return points, faces[~(behind & (np.linalg.norm(corners.mean(1) - line[0], axis=1) < 0.10))]


@pytest.mark.parametrize(
    ("s", "normal", "least"),
    [(0.05, (0.0, 0.0, 1.0), 0.0), (0.08, (0.5, 0.0, 1.0), 0.0), (0.0, (0.0, 0.0, 1.0), 0.014)],
    ids=["across", "slanting", "lengthwise"],
)
def test_open_tube_begins_at_its_opening(
    s: float, normal: tuple[float, float, float], least: float, tmp_path: Path
) -> None:
    """Cut lengthwise, the opening is a slit of 45 mm, and its middle is 14 mm along the tube."""
    points, faces = opened(tmp_path, s, normal)
    grid, openings = fill_surface(points, faces, VOXEL), find_openings(points, faces)
    found = find_path(grid, [None, None], "ras")
    assert found.cut == []
    assert np.linalg.norm(found.points[0] - openings[0].center) < np.linalg.norm(found.points[-1] - openings[0].center)
    path = center_path(grid, found.points, openings=openings)
    assert path[0] == pytest.approx(openings[0].center, abs=1e-3)
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert length == pytest.approx(course()[1] - s - least + RADIUS, rel=0.01)
