# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The anal canal is drawn anew: straight up, open, gently joined; and room is made for heads that do not pass."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.importing.canal import least_bend_radius, straighten_canal
from arcgym.anatomy.importing.headroom import room_for_head, widen_for_head
from arcgym.anatomy.importing.polar import cast_rings
from arcgym.anatomy.importing.smooth_centerline import plain_curve
from arcgym.anatomy.polyline import resample, smooth
from arcgym.anatomy.tubes import draw_tube
from arcgym.anatomy.validation.passage import HEAD_RADIUS
from arcgym.anatomy.voxel_grid import Grid

ZIGZAG = 1e-3 * np.array([(0, -30, 18), (0, 0, 18), (0, 0, 33), (0, 40, 45), (0, 55, 90), (0, 20, 170), (80, 20, 240)])
"""Way that leaves the anus level, turns up by a right angle, and forwards by nearly one after 15 mm [m]."""


def lumen(line: np.ndarray, radius: float, voxel: float = 0.002) -> Grid:
    low, high = line.min(0) - 0.03, line.max(0) + 0.03
    grid = Grid(np.zeros(np.ceil((high - low) / voxel).astype(int), np.float32), low, voxel)
    draw_tube(grid, line, np.full(len(line), radius))
    return grid


@pytest.fixture(scope="module")
def zigzag() -> np.ndarray:
    return smooth(resample(ZIGZAG, 0.001), 3.0)


def test_canal_is_straight_wide_and_gently_joined(zigzag: np.ndarray) -> None:
    assert least_bend_radius(zigzag[:60]) < 0.010
    grid, line, figures = straighten_canal(lumen(zigzag, 0.006), zigzag)
    curve = plain_curve(line)
    tangent = curve.frame(np.linspace(0.0, 0.028, 10))[0]
    assert np.degrees(np.arccos(tangent[:, 2])).max() < 1.0
    assert least_bend_radius(resample(line, 0.001)[: round(figures["new_length_mm"]) + 10]) > 0.030
    s = np.linspace(0.002, 1e-3 * figures["new_length_mm"], 20)
    assert cast_rings(grid, curve, s, 16).min() > 0.010
    assert figures["found_turn_within_3_cm_deg"] > 60


def test_old_canal_is_gone(zigzag: np.ndarray) -> None:
    grid, line, _ = straighten_canal(lumen(zigzag, 0.006), zigzag)
    assert np.linalg.norm(line[0] - zigzag[0]) > 0.015
    assert grid.sample(zigzag[:3]).max() < 0.5


def test_canal_keeps_off_another_loop() -> None:
    """A loop comes back beside a straight canal, 13 mm off: 4 mm of wall are left before its lumen of 6 mm radius."""
    up = np.stack([np.zeros(200), np.zeros(200), np.linspace(0.0, 0.2, 200)], 1)
    corners = [up[-1], [0.1, 0.0, 0.2], [0.1, 0.0, 0.06], [0.013, 0.0, 0.06], [0.013, 0.0, -0.03]]
    way = np.concatenate([up, resample(np.array(corners), 0.001)[1:]])
    before = lumen(way, 0.006)
    grid, _, _ = straighten_canal(before, way)
    drawn = grid.points(np.argwhere(grid.mask))
    drawn = drawn[(before.sample(drawn) < 0.5) & (drawn[:, 2] > -0.02) & (drawn[:, 2] < 0.02)]
    assert drawn[:, 0].min() < -0.009
    assert np.hypot(drawn[:, 0] - 0.013, drawn[:, 1]).min() > 0.006 + 0.004 - grid.spacing


def test_straight_canal_stays_as_it_is() -> None:
    line = np.stack([np.zeros(300), np.zeros(300), np.linspace(0.0, 0.299, 300)], 1)
    grid, way, figures = straighten_canal(lumen(line, 0.012), line)
    assert figures["turn_deg"] < 1.0
    assert figures["new_length_mm"] == pytest.approx(figures["replaced_mm"], abs=1.5)
    assert np.linalg.norm(way[0] - line[0]) < 0.002


def test_collapsed_lumen_is_widened_for_the_head() -> None:
    """A tube of 5 mm radius round an arc of 40 mm takes no head of 6.6 mm; one of 8 mm drawn into it makes room."""
    angle = np.linspace(0.0, 2.0, 80)
    line = 0.04 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], 1)
    grid = lumen(line, 0.005, voxel=0.001)
    assert room_for_head(grid, line).least < 0.005
    out, figures = widen_for_head(grid, line, 0.008)
    assert figures["share"] == 1.0
    assert room_for_head(out, line).least > HEAD_RADIUS
    assert (out.values >= grid.values).all()


def test_wide_lumen_is_not_touched() -> None:
    line = np.stack([np.zeros(100), np.zeros(100), np.linspace(0.0, 0.2, 100)], 1)
    grid = lumen(line, 0.015)
    out, figures = widen_for_head(grid, line, 0.008)
    assert figures["share"] == 0.0
    assert (out.values == grid.values).all()
