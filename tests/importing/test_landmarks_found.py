# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Borders come with how far they may be off; valve and appendix are kept; leaks are reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from label_volumes import RADIUS, course, write_volume
from test_attached import found_in, tube

from arcgym.anatomy.importing.border_uncertainty import border_uncertainty
from arcgym.anatomy.importing.cecal_openings import APPENDIX, VALVE, cecal_openings
from arcgym.anatomy.importing.lumen import anus_and_cecum
from arcgym.anatomy.importing.openings import Opening
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.polyline import arc_lengths, resample, smooth


def with_humps(left: float, right: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a course whose left flexure has two humps of some heights [m], 12 cm apart, and its arc length."""
    corners = [(0, 0, 0), (0, 0, 0.15), (-0.13, 0, 0.16), (-0.15, 0, left), (-0.12, 0.02, 0.28), (-0.06, 0.03, right)]
    corners += [(-0.04, 0.06, 0.2), (0.04, 0.06, 0.2), (0.10, 0.02, 0.3), (0.13, 0, 0.3), (0.13, 0, 0.05)]
    points = smooth(resample(np.array(corners), 0.002), 8.0)
    return points, arc_lengths(points)


def test_two_humps_of_a_height_make_the_flexure_uncertain() -> None:
    sure = border_uncertainty(*with_humps(0.40, 0.29), {})["splenic_flexure_entry"]
    unsure = border_uncertainty(*with_humps(0.36, 0.355), {})["splenic_flexure_entry"]
    assert sure < 0.02
    assert unsure > 0.05


def test_given_landmark_is_certain() -> None:
    found = border_uncertainty(*with_humps(0.40, 0.29), {"rectosigmoid": 0.14})
    assert found["rectosigmoid"] == 0.0
    assert found["sigmoid_descending"] > 0.005


def test_valve_and_appendix_lie_where_they_were_cut_off() -> None:
    """A tube of 20 mm leaves 6 cm before the pole, one of 7 mm 2 cm before it, one of 20 mm in the transverse colon."""
    line = np.stack([np.zeros(501), np.zeros(501), np.linspace(0.0, 1.0, 501)], 1)
    cut = [
        {"kind": "side branch", "caliber_mm": 20.0, "neck_mm": 12.0, "volume_ml": 30.0, "place_mm": [20, 0, 940]},
        {"kind": "small bowel", "caliber_mm": 7.0, "neck_mm": 4.0, "volume_ml": 2.0, "place_mm": [0, 20, 980]},
        {"kind": "side branch", "caliber_mm": 20.0, "neck_mm": 12.0, "volume_ml": 90.0, "place_mm": [20, 0, 500]},
        {"kind": "hole in the rectum, filled", "volume_ml": 3.0},
    ]
    found = cecal_openings(line, cut, np.eye(3))
    assert set(found) == {VALVE, APPENDIX}
    assert found[VALVE].arc == pytest.approx(0.94, abs=0.003)
    assert found[VALVE].radius == pytest.approx(0.006)
    assert found[APPENDIX].position == pytest.approx([0.0, 0.02, 0.98])


def test_only_opening_is_the_anus() -> None:
    opening = Opening(np.array([0.1, 0.0, 0.0]), 0.012)
    assert anus_and_cecum(ImportSettings(), [])[0] == [None, None]
    assert anus_and_cecum(ImportSettings(), [opening, opening])[0][0] is None
    (anus, _), source = anus_and_cecum(ImportSettings(), [opening])
    assert anus == pytest.approx([0.1, 0.0, 0.0])
    assert source == "only opening"
    assert anus_and_cecum(ImportSettings(anus=(1.0, 2.0, 3.0)), [opening])[1] == "given"
    assert anus_and_cecum(ImportSettings(cecum=(105.0, 0.0, 0.0)), [opening])[0][0] is None


def test_leak_behind_a_narrow_neck_is_cut_off(tmp_path: Path) -> None:
    """A blob of 9 mm radius beyond a neck of 3 mm, 30 mm beside the wall, is no pouch; it was left and not reported."""
    line, _ = course()
    middle = line[np.linalg.norm(line - [-0.14, -0.03, 0.22], axis=1).argmin()]
    neck = tube(middle, (-0.055, 0.0, 0.0))
    blob = middle + np.array([-0.045, 0.0, 0.0])
    ball = blob + 0.006 * np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    extra = np.concatenate([neck[::1], ball])
    path = write_volume(tmp_path / "a.mha", extra=extra, extra_radius=0.004, voxel=2.0)
    grid, found = found_in(path)
    assert "leak" in {cut["kind"] for cut in found.cut} | {pouch["kind"] for pouch in found.pouches}
    assert grid.sample(blob[None]).max() < 0.5


def test_wide_pouch_is_left_and_reported(tmp_path: Path) -> None:
    """A pouch as wide as the tube, 25 mm long beyond its wall, may be the colon's own."""
    line, _ = course()
    middle = line[np.linalg.norm(line - [-0.14, -0.03, 0.22], axis=1).argmin()]
    pouch = tube(middle, (-0.016 - 0.028, 0.0, 0.0))
    grid, found = found_in(write_volume(tmp_path / "a.mha", extra=pouch, extra_radius=0.8 * RADIUS))
    assert found.cut == []
    assert [piece["kind"] for piece in found.pouches] == ["pouch"]
    assert grid.sample(pouch[-1][None])[0] > 0.5
