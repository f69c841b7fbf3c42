# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The camera of the outside view sees everything from the side it was asked to."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arcgym.viewers.view_camera import frame_points

CORNERS = np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.1, 0.1) for z in (0.0, 0.5)])


@pytest.mark.parametrize("azimuth", [0.0, 0.7, math.pi / 2, math.pi])
@pytest.mark.parametrize("elevation", [-0.4, 0.0, 0.9])
def test_all_points_are_inside_and_fill_one_direction(azimuth, elevation):
    camera = frame_points(CORNERS, (560, 512), azimuth, elevation, margin=1.0)
    pixels = camera.project(CORNERS)
    assert pixels.min() > -1.0 and (pixels < np.array([561, 513])).all()
    spread = np.ptp(pixels, axis=0) / (560, 512)
    assert spread.max() == pytest.approx(1.0, abs=0.01)


def test_front_view_shows_the_patients_right_on_the_left_and_the_head_up():
    camera = frame_points(CORNERS, (560, 512))
    right, left, head = camera.project(np.array([[0.1, 0, 0.2], [-0.1, 0, 0.2], [0, 0, 0.4]]))
    assert right[0] < left[0]
    assert head[1] < right[1]
    assert camera.eye[1] > 1.0


def test_quarter_turn_looks_from_the_patients_left():
    assert frame_points(CORNERS, (560, 512), azimuth=math.pi / 2).eye[0] < -1.0


def test_scale_is_the_projected_length_of_a_meter():
    camera = frame_points(CORNERS, (560, 512))
    a, b = camera.project(np.array([[0.0, 0.0, 0.25], [-0.01, 0.0, 0.25]]))
    assert 100 * (b[0] - a[0]) == pytest.approx(camera.pixels_per_meter(np.array([0.0, 0.0, 0.25])), rel=1e-6)


def test_steep_elevation_is_refused():
    with pytest.raises(ValueError, match="85"):
        frame_points(CORNERS, (560, 512), elevation=1.57)
