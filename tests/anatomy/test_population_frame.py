# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where random patients' flexures and borders lie."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from arcgym.anatomy.generator.centerline import make_centerline
from arcgym.anatomy.generator.population import ASCENDING_LENGTH, DESCENDING_LENGTH, ILIAC_FOSSA, draw_spec
from arcgym.anatomy.generator.routes import control_points
from arcgym.anatomy.generator.spec import ColonSpec


def points(**changes: float | bool) -> dict[str, np.ndarray]:
    return control_points(replace(ColonSpec(), **changes), np.random.default_rng(0))


def test_flexures_rise_and_carry_the_transverse_colon_along() -> None:
    """The iliac fossae stay; the transverse colon passes from one rise to the other."""
    rise = {name: route[:, 2] - points()[name][:, 2] for name, route in points(left_rise=0.04, right_rise=0.02).items()}
    assert rise["sigmoid"] == pytest.approx(0.0) and rise["cecum"] == pytest.approx(0.0)
    assert rise["splenic"] == pytest.approx(0.04) and rise["hepatic"] == pytest.approx(0.02)
    assert rise["transverse"][[0, -1]] == pytest.approx([0.04, 0.02])
    assert np.all(np.diff(rise["descending"]) > 0.0) and np.all(np.diff(rise["ascending"]) < 0.0)


def test_straight_cecum_has_its_full_length_without_jitter() -> None:
    """Everything before it stays as it was."""
    straight, free = points(), points(straight_cecum=False)
    assert straight["ascending"] == pytest.approx(free["ascending"])
    chords = np.linalg.norm(np.diff(straight["cecum"], axis=0), axis=1)
    assert chords.sum() == pytest.approx(ColonSpec().segments["cecum"].length, abs=0.005)


def test_cecum_of_random_patients_turns_gently() -> None:
    """Forwards and to the middle, by less than 45 degrees, on a radius larger than its lumen's."""
    spec = draw_spec(26)
    curve = make_centerline(spec, np.random.default_rng(26))
    s = np.linspace(*curve.bounds("cecum"), 20)
    way = curve.frame(s)[0]
    assert way[0] @ way[-1] > np.cos(np.radians(45.0))
    assert way[-1][0] < 0.0 < way[-1][1]
    curvature = curve.interpolate(s, curve.curvature[:, None])
    assert curvature.max() * 0.5 * spec.segments["cecum"].middle_diameter < 0.75


def test_random_patients_are_as_high_as_their_flank_is_long() -> None:
    for seed in range(5):
        spec = draw_spec(seed)
        assert spec.left_rise == pytest.approx(spec.segments["descending"].length - DESCENDING_LENGTH, abs=1e-4)
        assert spec.right_rise == pytest.approx(spec.segments["ascending"].length - ASCENDING_LENGTH, abs=1e-4)


def test_descending_colon_ends_in_the_iliac_fossa() -> None:
    """Without a height, it ends where the lengths put it; the course is the same."""
    spec = draw_spec(10)
    curve, other = (
        make_centerline(each, np.random.default_rng(10)) for each in (spec, replace(spec, iliac_fossa=None))
    )
    assert curve.position(np.array(curve.bounds("descending")[0]))[2] == pytest.approx(ILIAC_FOSSA, abs=0.001)
    assert curve.points == pytest.approx(other.points)
    assert np.delete(curve.ends, 1) == pytest.approx(np.delete(other.ends, 1))
    assert abs(curve.ends[1] - other.ends[1]) > 0.005
