# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Acute bends: counted on arcs whose turn a reader can work out, and made where they are asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from arcgym.anatomy.bends import WINDOW, acute_bends, turning
from arcgym.anatomy.course_measures import measure_course
from arcgym.anatomy.generator.acute_bends import WIDEST
from arcgym.anatomy.generator.centerline import make_centerline
from arcgym.anatomy.generator.spec import ColonSpec


def hairpins(radius: float, turns: list[float], leg: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Return a planar course of arcs with the given turns [rad] between straight legs, and its arc length."""
    step = 0.001
    curvature = np.zeros(round(leg / step))
    for turn in turns:
        arc = np.full(round(abs(turn) * radius / step), np.sign(turn) / radius)
        curvature = np.r_[curvature, arc, np.zeros(round(leg / step))]
    angle = np.cumsum(curvature) * step
    points = np.cumsum(np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1), axis=0) * step
    return points, step * np.arange(len(points))


def test_turn_of_a_circle_is_the_window_over_its_radius() -> None:
    points, arc = hairpins(0.050, [np.pi])
    assert turning(points, arc)[1].max() == pytest.approx(WINDOW / 0.050, rel=0.01)


@pytest.mark.parametrize(("turns", "count"), [([1.2], 0), ([1.9], 1), ([np.pi], 1), ([1.9, -1.9, 1.9], 3), ([], 0)])
def test_bends_of_30_mm_radius(turns: list[float], count: int) -> None:
    """1.2 rad is 69 degrees; 1.9 rad is 109 degrees over 57 mm; a hairpin is one bend."""
    assert len(acute_bends(*hairpins(0.030, turns))) == count


def test_wide_turn_is_not_acute() -> None:
    """At a radius of 60 mm, 60 mm turn by 57 degrees only."""
    assert len(acute_bends(*hairpins(0.060, [np.pi]))) == 0


def test_widest_arc_that_is_made_turns_enough() -> None:
    assert WINDOW / WIDEST > np.radians(90.0)


@pytest.mark.parametrize("wanted", [7, 10])
def test_wanted_bends_are_made(wanted: int) -> None:
    spec = replace(ColonSpec(), acute_bends=wanted, sigmoid_shape="angulated")
    curve = make_centerline(spec, np.random.default_rng(3))
    assert len(acute_bends(curve.points, curve.s)) == pytest.approx(wanted, abs=1)
    assert measure_course(curve.points).bend_radius_least > 0.8 * spec.min_bend_radius
