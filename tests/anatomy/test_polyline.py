# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Polylines and steps whose values a reader can see."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.polyline import arc_lengths, resample, restore_lengths, smooth

CORNER = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0]])


def test_arc_length_adds_up_edges() -> None:
    assert arc_lengths(CORNER).tolist() == [0.0, 3.0, 4.0]


def test_resampled_points_lie_on_the_edges() -> None:
    assert resample(CORNER, 2.0) == pytest.approx(np.array([[0.0, 0, 0], [2.0, 0, 0], [3.0, 1.0, 0]]))


def test_smoothing_keeps_ends_and_straight_lines() -> None:
    line = np.linspace([0.0, 0.0, 0.0], [1.0, 2.0, 3.0], 30)
    assert smooth(line, 2.0) == pytest.approx(line)


def test_both_ends_of_a_short_edge_move() -> None:
    """An edge of 1 that has to be 2 long: each end moves by a half."""
    points = np.array([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    restore_lengths(points, np.array([2.0]), np.zeros((3, 0)), rounds=1)
    assert points[0].tolist() == [-0.5, 1.5]


def test_fixed_points_move_the_others() -> None:
    points = np.array([[0.0, 1.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    restore_lengths(points, np.array([1.0, 1.0]), np.array([[0.5], [0.0], [0.0]]), rounds=60)
    assert np.abs(np.linalg.norm(np.diff(points), axis=0) - 1.0).max() < 0.05


def test_smooth_step_is_a_half_in_the_middle() -> None:
    assert smooth_step(1.0, 3.0, np.array([0.0, 1.0, 2.0, 3.0, 9.0])).tolist() == [0.0, 0.0, 0.5, 1.0, 1.0]
