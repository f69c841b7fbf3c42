# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small bowel and a rectal tube that hang on the lumen are cut off and reported; gaps are bridged end to end."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from label_volumes import RADIUS, course, write_volume

from arcgym.anatomy.importing.anal_end import into_the_canal
from arcgym.anatomy.importing.cleaning import keep_colon
from arcgym.anatomy.importing.clearance import coarse_clearance
from arcgym.anatomy.importing.path_search import FoundPath, find_path
from arcgym.anatomy.importing.tree import lumen_tree
from arcgym.anatomy.importing.volumes import read_volume
from arcgym.anatomy.voxel_grid import Grid


def found_in(path: Path, label: tuple[int, ...] | None = None) -> tuple[Grid, FoundPath]:
    grid, _ = keep_colon(read_volume(path, label, None, 0.003), 0.05)
    return grid, find_path(grid, [None, None], "ras")


def length(path: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(path[::5], axis=0), axis=1).sum())


def tube(start: np.ndarray, *moves: tuple[float, float, float]) -> np.ndarray:
    """Return points every 2 mm along straight pieces."""
    corners = np.cumsum([start, *np.array(moves)], axis=0)
    pieces = zip(corners[:-1], corners[1:], strict=True)
    return np.concatenate(
        [a + np.linspace(0, 1, round(np.linalg.norm(b - a) / 0.002))[:, None] * (b - a) for a, b in pieces]
    )


@pytest.mark.parametrize("radius", [0.006, 0.010])
def test_small_bowel_is_cut_off(radius: float, tmp_path: Path) -> None:
    """A tube of 20 cm leaves the tube of 32 mm 6 cm before its end, sideways."""
    line, _ = course()
    leak = tube(line[-30], (0.0, 0.09, 0.0), (0.0, 0.0, -0.08), (-0.06, 0.0, 0.0))
    grid, found = found_in(write_volume(tmp_path / "a.mha", extra=leak, extra_radius=radius))
    (cut,) = found.cut
    assert cut["length_mm"] == pytest.approx(1e3 * (0.23 - RADIUS), abs=30)
    assert cut["caliber_mm"] == pytest.approx(2e3 * radius, abs=5)
    assert grid.sample(leak[60:]).max() < 0.5
    assert np.linalg.norm(found.points[[0, -1]] - line[[0, -1]], axis=1).max() < 0.025


def test_tube_beyond_the_anus_is_cut_off(tmp_path: Path) -> None:
    line, _ = course()
    pipe = tube(line[0], (0.0, 0.0, -0.08))
    grid, found = found_in(write_volume(tmp_path / "a.mha", extra=pipe, extra_radius=0.005, voxel=2.0))
    assert [cut["kind"] for cut in found.cut] == ["rectal tube"]
    assert grid.sample(pipe[20:]).max() < 0.5


def test_collapsed_anal_canal_is_kept(tmp_path: Path) -> None:
    line, _ = course()
    canal = tube(line[0], (0.0, 0.0, -0.045))
    found = found_in(write_volume(tmp_path / "a.mha", extra=canal, extra_radius=0.003, voxel=2.0))[1]
    assert found.cut == []
    assert found.points[0] == pytest.approx(canal[-1], abs=0.01)


def test_collapsed_stretch_is_no_end(tmp_path: Path) -> None:
    """Where the lumen is a thread for 4 cm, the colon goes on beyond."""
    line, whole = course()
    thread = line[len(line) // 2 - 22 : len(line) // 2 + 22]
    path = write_volume(tmp_path / "a.mha", gap=0.04 + 2 * RADIUS, extra=thread, extra_radius=0.0025, voxel=2.0)
    found = found_in(path)[1]
    assert found.cut == []
    assert length(found.points) == pytest.approx(whole, rel=0.06)


def test_small_bowel_joined_at_both_ends_is_no_short_cut(tmp_path: Path) -> None:
    """A loop runs straight from the descending colon to the transverse colon, 20 cm less than the way round."""
    line, whole = course()
    first, last = (line[np.linalg.norm(line - p, axis=1).argmin()] for p in ([-0.14, -0.02, 0.20], [0.0, 0.09, 0.24]))
    loop = tube(first, tuple(last - first))
    grid, found = found_in(write_volume(tmp_path / "a.mha", extra=loop, extra_radius=0.008))
    assert length(found.points) == pytest.approx(whole, rel=0.06)
    assert {cut["kind"] for cut in found.cut} == {"side branch"}
    assert grid.sample(loop[len(loop) // 2][None]).max() < 0.5


def test_balloon_in_the_rectum_is_filled(tmp_path: Path) -> None:
    """A ball with a radius of 9 mm in the middle of the lumen: its sections are holes."""
    line, _ = course()
    grid, _ = keep_colon(read_volume(write_volume(tmp_path / "a.mha", voxel=2.0), None, None, 0.002), 0.05)
    voxels = grid.points(np.indices(grid.values.shape).reshape(3, -1).T)
    hole = (np.linalg.norm(voxels - line[12], axis=1) < 0.009).reshape(grid.values.shape)
    grid.values[hole] = 0.0
    assert find_path(grid, [None, None], "ras").filled_hole == pytest.approx(4 / 3 * np.pi * 0.009**3, rel=0.3)
    assert grid.sample(line[12][None])[0] > 0.5


def test_nothing_is_cut_off_a_plain_tube(tmp_path: Path) -> None:
    assert found_in(write_volume(tmp_path / "a.mha"))[1].cut == []


@pytest.mark.parametrize("gap", [0.005, 0.020, 0.040])
def test_gap_is_bridged_along_the_lumen(gap: float, tmp_path: Path) -> None:
    _, whole = course()
    path = write_volume(tmp_path / "a.mha", gap=gap + 2 * RADIUS)
    grid, cleaning = keep_colon(read_volume(path, None, None, 0.003), 0.05)
    (bridge,) = cleaning.bridges
    assert bridge["gap_mm"] == pytest.approx(1e3 * gap, abs=6)
    assert length(find_path(grid, [None, None], "ras").points) == pytest.approx(whole, rel=0.06)


def test_bridge_is_as_wide_as_the_lumen_on_either_side(tmp_path: Path) -> None:
    """The tube's radius is 16 mm; in the middle of a gap of 30 mm it was 5 mm."""
    line, _ = course()
    path = write_volume(tmp_path / "a.mha", gap=0.03 + 2 * RADIUS, voxel=2.0)
    grid, cleaning = keep_colon(read_volume(path, None, None, 0.002), 0.05)
    middle = line[len(line) // 2 - 2 : len(line) // 2 + 3]
    across = np.cross(middle[-1] - middle[0], [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    ray = middle[2] + np.linspace(-0.03, 0.03, 121)[:, None] * across
    assert (grid.sample(ray) > 0.5).sum() * 0.0005 == pytest.approx(2 * RADIUS, abs=0.006)
    assert cleaning.bridges[0]["radius_mm"] == pytest.approx([16, 16], abs=3)


def test_air_and_fluid_may_have_labels_of_their_own(tmp_path: Path) -> None:
    """Fluid of label 2 continues the tube."""
    line, whole = course()
    path = write_volume(tmp_path / "a.mha", extra=tube(line[-1], (0.0, 0.0, -0.08)), extra_radius=RADIUS, value=2)
    assert length(found_in(path, (1, 2))[1].points) > length(found_in(path, (1,))[1].points) + 0.05


def test_path_into_a_corner_of_the_rectum_is_led_into_the_canal(tmp_path: Path) -> None:
    """A canal of 45 mm leaves downwards, a pouch of 30 mm sideways; the tube between them is 16 mm in radius."""
    line, _ = course()
    canal, pouch = tube(line[0], (0.0, 0.0, -0.045)), tube(line[0], (-0.03, 0.0, 0.0))
    path = write_volume(tmp_path / "a.mha", extra=np.concatenate([canal, pouch]), extra_radius=0.008, voxel=2.0)
    tree = lumen_tree(coarse_clearance(read_volume(path, None, None, 0.002)))

    def tip_at(place: np.ndarray) -> int:
        return min(tree.tips, key=lambda tip: float(np.linalg.norm(tree.points[tip] - place)))

    right, wrong = (tree.between(tip_at(end), tip_at(line[-1])) for end in (canal[-1], pouch[-1]))
    assert right[0] != wrong[0]
    assert into_the_canal(tree, wrong)[0] == right[0]
    assert into_the_canal(tree, right)[0] == right[0]
