# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The tube whose bend is tighter than its lumen is wide: rings that do not cross, a surface that is there."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from arcgym.anatomy import ColonStage
from arcgym.anatomy.course_measures import measure_course
from arcgym.benchmarks.fidelity.folded_tube import SHARE, folded_stage, folded_tube


@pytest.fixture(scope="module")
def stage() -> ColonStage:
    return folded_stage(folded_tube())


def test_bend_is_tighter_than_the_lumen_is_wide(stage: ColonStage) -> None:
    """15.5 mm under a lumen of 17.2 mm."""
    least = measure_course(stage.centerline.points.astype(float)).bend_radius_least
    assert least == pytest.approx(0.0155, abs=0.0015)
    assert np.median(stage.centerline.radius) == pytest.approx(0.0155 / SHARE, abs=0.0005)


def test_rings_do_not_cross(stage: ColonStage) -> None:
    rings = len(stage.wall.ring_arc)
    outer = stage.wall.points.reshape(2, rings, -1, 3)[1]
    assert np.linalg.norm(np.diff(outer, axis=0), axis=2).min() > 0.003


def test_what_the_scope_touches_is_the_tube(stage: ColonStage) -> None:
    """Points 2 to 30 cm up are a lumen's radius from the course, 1 mm at the 95th percentile."""
    assert stage.contact is not None and folded_tube().radius is not None
    course = folded_tube().frame(np.arange(0.0, folded_tube().length, 0.0005))[0]
    away, nearest = cKDTree(course).query(stage.contact.points)
    inside = (nearest > 40) & (nearest < 600)
    assert np.percentile(np.abs(away[inside] - folded_tube().radius), 95) < 0.001
