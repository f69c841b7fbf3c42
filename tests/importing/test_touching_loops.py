# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Loops that touch: the path goes the long way round, a wall is put between them, and what is doubtful is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from arcgym.anatomy.importing import ColonImportError
from arcgym.anatomy.importing.doubts import check_doubts, path_doubts, refuse
from arcgym.anatomy.importing.loop_windows import close_windows
from arcgym.anatomy.importing.path_search import find_path
from arcgym.anatomy.polyline import resample
from arcgym.anatomy.tubes import draw_tube
from arcgym.anatomy.voxel_grid import Grid

RADIUS = 0.016
SITES = 1e-3 * np.array(
    [(0, 0, 0), (0, -40, 70), (30, 0, 130), (20, 50, 200), (-12, 55, 170), (-14, 55, 110), (-14, 55, 50)]
    + [(-28, 55, 25), (-42, 55, 50), (-42, 55, 110), (-44, 55, 170), (-60, 45, 215), (-120, 0, 180), (-150, -40, 220)]
    + [(-150, -50, 320), (-80, 50, 330), (0, 100, 260), (80, 50, 320), (140, -30, 310), (135, -10, 110)]
)
"""Course of a colon [m]; in the sigmoid two limbs run beside each other, 28 mm apart, for 12 cm."""


@pytest.fixture(scope="module")
def line() -> np.ndarray:
    spline = CubicSpline(np.linspace(0, 1, len(SITES)), SITES)
    return resample(spline(np.linspace(0, 1, 4000)), 0.002)


def length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def lumen(line: np.ndarray, voxel: float = 0.002, radius: float = RADIUS) -> Grid:
    low, high = line.min(0) - 0.03, line.max(0) + 0.03
    grid = Grid(np.zeros(np.ceil((high - low) / voxel).astype(int), np.float32), low, voxel)
    draw_tube(grid, line, np.full(len(line), radius))
    return grid


def limbs_apart(line: np.ndarray) -> float:
    """Return the least distance of places more than 10 cm apart along the course."""
    tree = cKDTree(line)
    return min(float(np.linalg.norm(line[a] - line[b])) for a, b in tree.query_pairs(0.05) if abs(a - b) * 0.002 > 0.10)


def test_loops_of_the_phantom_touch(line: np.ndarray) -> None:
    assert limbs_apart(line) < 2 * RADIUS


@pytest.mark.parametrize(("radius", "farthest"), [(RADIUS, 0.045), (0.018, 0.018)])
def test_path_goes_the_long_way_round(radius: float, farthest: float, line: np.ndarray) -> None:
    """The short cut is 19 cm shorter; with 16 mm the last 4 cm of the hairpin are left out as a pouch would be."""
    found = find_path(lumen(line, radius=radius), [None, None], "ras")
    assert found.closed
    assert length(found.points[::5]) > 0.925 * length(line)
    assert cKDTree(found.points).query(line[20:-20])[0].max() < farthest


def test_wall_is_put_between_the_loops(line: np.ndarray) -> None:
    """Half-way between two places that lie side by side there is lumen before, and none after; the way stays open."""
    grid = lumen(line)
    out, windows = close_windows(grid, line)
    pairs = [(a, b) for a, b in cKDTree(line).query_pairs(1.85 * RADIUS) if abs(a - b) * 0.002 > 0.12]
    assert pairs and windows
    middle = np.array([0.5 * (line[a] + line[b]) for a, b in pairs])
    assert grid.sample(middle).min() > 0.5
    assert out.sample(middle).max() < 0.5
    assert out.sample(line[5:-5]).min() > 0.5
    assert windows[0]["area_mm2"] == pytest.approx(1e6 * 0.09 * 2 * np.sqrt(RADIUS**2 - 0.014**2), rel=0.6)


def test_loops_that_do_not_touch_stay_as_they_are(line: np.ndarray) -> None:
    grid = lumen(line, radius=0.010)
    out, windows = close_windows(grid, line)
    assert windows == []
    assert out is grid


def report(**changes: Any) -> dict[str, Any]:
    """Return figures of a good import, with changes."""
    good = {
        "cleaning": {"cut": [], "dropped": []},
        "orientation": {"likeness": 0.9, "mirrored": False},
        "volume_ml": 2000.0,
        "lost_ml": 0.0,
        "caliber_mm": 40.0,
    }
    return good | changes


def branch(length: float, caliber: float, volume: float) -> dict[str, Any]:
    figures = {"length_mm": length, "caliber_mm": caliber, "volume_ml": volume}
    return {"kind": "side branch", "place_mm": [1, 2, 3], **figures}


def test_good_import_leaves_no_doubt() -> None:
    small_bowel = branch(600, 18, 150.0)
    assert path_doubts(report(cleaning={"cut": [small_bowel], "dropped": [{"volume_ml": 90.0}]})) == []


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        (
            {"cleaning": {"cut": [branch(300, 20, 400.0)], "dropped": []}},
            r"17% of the lumen was cut off.*\[1, 2, 3\].*--anus",
        ),
        (
            {"cleaning": {"cut": [branch(120, 30, 100.0)], "dropped": []}},
            "as wide as the colon .40 mm.*separate the loops",
        ),
        ({"cleaning": {"cut": [], "dropped": [{"volume_ml": 500.0, "place_mm": [4, 5, 6]}]}}, "left out.*--max-gap"),
        (
            {"cleaning": {"cut": [branch(k, 30, 50.0) for k in (70, 90, 80)], "dropped": []}},
            "is 90 mm long .*2 more are like it",
        ),
        (
            {"orientation": {"likeness": 0.5, "mirrored": False}},
            r"likeness 0.50, usually 0.6 and more\). Pass --anus and",
        ),
        ({"orientation": {"likeness": 0.5, "mirrored": True}}, "Left and right may be exchanged in the file.*--anus"),
    ],
)
def test_doubtful_import_is_refused(changes: dict[str, Any], match: str) -> None:
    (doubt,) = path_doubts(report(**changes))
    with pytest.raises(ColonImportError, match=f"Doubtful: .*{match}.*--keep-doubtful"):
        refuse([doubt])


def test_failed_check_is_a_doubt() -> None:
    kept = {"name": "gap", "value": 0.004, "bound": 0.003, "ok": True}
    failed = {"name": "least lumen radius [m]", "value": 0.005, "bound": 0.0066, "ok": False}
    assert check_doubts([kept]) == []
    assert "least lumen radius [m] is 0.005, bound 0.0066" in check_doubts([kept, failed])[0]
