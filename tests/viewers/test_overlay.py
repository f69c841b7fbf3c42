# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The overlay stays inside its box, whatever it has to show."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image, ImageDraw

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs.mdp import ForceTiersCfg
from arcgym.viewers.drawing import INK
from arcgym.viewers.frame_info import FrameInfo
from arcgym.viewers.overlay import Cell, cells, draw_cells, draw_panel, octagon
from arcgym.viewers.palette import FORCE_TIERS, shown_tiers
from arcgym.viewers.segment_bar import draw_segment_bar
from arcgym.viewers.sparkline import draw_sparkline
from arcgym.viewers.tier_bar import draw_tier_bar

GROUND = (1, 2, 3)
BOUNDS = {name: (0.2 * k, 0.2 * (k + 1)) for k, name in enumerate(SEGMENTS)}
WIDE = FrameInfo(
    time=999.9,
    segment="descending",
    tip_arc=1.234,
    inserted=1.876,
    tip_force=123.4,
    max_force=123.4,
    reward=-12.34,
    task_range=(0.4, 0.6),
    terms={f"a long name {k}": -12.34 for k in range(9)},
)


class Canvas:
    """A picture with a box in it; tells whether anything was drawn inside and outside the box."""

    def __init__(self, width: int = 400, height: int = 80):
        self.box = (20, 20, 20 + width, 20 + height)
        self.picture = Image.new("RGB", (width + 40, height + 40), GROUND)
        self.draw = ImageDraw.Draw(self.picture)

    def is_drawn(self) -> np.ndarray:
        return (np.asarray(self.picture) != GROUND).any(axis=2)

    def assert_inside(self) -> None:
        drawn = self.is_drawn()
        assert drawn[20:-20, 20:-20].sum() > 50
        drawn[20:-19, 20:-19] = False
        assert not drawn.any()


@pytest.mark.parametrize("width", [1080, 500])
def test_panel_stays_inside(width):
    canvas = Canvas(width, 88)
    draw_panel(canvas.draw, canvas.box, WIDE, BOUNDS, [-5.0, 0.2, 9.0], [0.0, 30.0, 1.0])
    canvas.assert_inside()


@pytest.mark.parametrize("tip", [-0.1, 0.0, 0.7, 1.6, 9.0])
def test_segment_bar_keeps_its_marker_inside(tip):
    canvas = Canvas(300, 30)
    draw_segment_bar(canvas.draw, canvas.box, BOUNDS, tip)
    canvas.assert_inside()


def test_marker_stands_over_the_tip():
    canvas = Canvas(800, 30)
    draw_segment_bar(canvas.draw, canvas.box, BOUNDS, 0.4)
    columns = np.flatnonzero(canvas.is_drawn()[21])
    assert columns.mean() == pytest.approx(20 + 800 * 0.4 / 1.6, abs=1.5)


def test_narrow_segments_take_short_names_or_none():
    canvas = Canvas(60, 30)
    draw_segment_bar(canvas.draw, canvas.box, BOUNDS, 0.4)
    canvas.assert_inside()


def test_cells_that_do_not_fit_are_left_out():
    canvas = Canvas(250, 50)
    shown = [Cell("label", "1.0", "00.0") for _ in range(40)]
    count = draw_cells(canvas.draw, canvas.box, shown)
    assert 2 < count < 40
    canvas.assert_inside()


def test_cells_hold_the_numbers_with_units_and_tier_colors():
    by_label = {cell.label: cell for cell in cells(FrameInfo(segment="sigmoid", tip_arc=0.325, max_force=6.0))}
    assert by_label["tip in sigmoid"].value == "32.5 cm"
    assert by_label["shaft force"].value == "6.0 N"
    assert by_label["shaft force"].dot != by_label["tip force"].dot
    assert "reward" not in by_label


def test_the_window_with_the_largest_force_and_the_loop_are_told():
    by_label = {cell.label: cell.value for cell in cells(FrameInfo(max_force=6.0, max_force_arc=0.125, looping=1.304))}
    assert (by_label["from the tip"], by_label["loop ratio"]) == ("12 cm", "1.30")
    by_label = {cell.label: cell.value for cell in cells(FrameInfo())}
    assert by_label["from the tip"] == "-" and "loop ratio" not in by_label


def test_tip_force_names_its_tier_and_stands_on_the_bar():
    by_label = {cell.label: cell for cell in cells(FrameInfo(tip_force=6.0, max_force=1.0))}
    assert (by_label["tip force"].note, by_label["tip force"].force) == ("unsafe", 6.0)
    gentle = shown_tiers(ForceTiersCfg(comfort=7.0, unsafe=8.0))
    assert {cell.label: cell for cell in cells(FrameInfo(tip_force=6.0), gentle)}["tip force"].note == "comfort"


@pytest.mark.parametrize("force", [0.0, 1.0, 14.1, 500.0])
def test_tier_bar_stays_inside(force):
    canvas = Canvas(100, 8)
    draw_tier_bar(canvas.draw, canvas.box, force, FORCE_TIERS)
    canvas.assert_inside()


def test_tier_bar_is_marked_at_the_root_of_the_force():
    canvas = Canvas(100, 8)
    # The bar ends at 1.5 * 14.1 N; a quarter of that stands half way.
    draw_tier_bar(canvas.draw, canvas.box, 1.5 * 14.1 / 4, FORCE_TIERS)
    columns = np.flatnonzero((np.asarray(canvas.picture)[20] == INK).all(axis=1))
    assert columns.mean() == pytest.approx(70, abs=1.5)


@pytest.mark.parametrize("values", [[], [1.0], [float("nan")] * 3, [0.0, 100.0, float("nan"), -100.0] * 60])
def test_sparkline_stays_inside(values):
    canvas = Canvas(120, 46)
    draw_sparkline(canvas.draw, canvas.box, values, "label", (255, 0, 0), (0.0, 1.0), [(0.5, (0, 255, 0))])
    canvas.assert_inside()


def test_sparkline_rises_with_its_values():
    canvas = Canvas(120, 46)
    draw_sparkline(canvas.draw, canvas.box, np.linspace(0, 1, 20), "", (255, 0, 0), (0.0, 1.0), capacity=20)
    rows, columns = np.nonzero((np.asarray(canvas.picture) == (255, 0, 0)).all(axis=2))
    assert rows[columns < 50].mean() > rows[columns > 110].mean() + 10


def test_octagon_cuts_corners_only():
    picture = np.full((64, 64, 3), 200, np.uint8)
    cut = np.asarray(octagon(picture, ground=GROUND))
    assert tuple(cut[0, 0]) == tuple(cut[-1, -1]) == GROUND
    assert (cut[32] == 200).all() and (cut[:, 32] == 200).all()
