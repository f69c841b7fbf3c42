# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The equidistant fisheye."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.assets.endoscope_spec import CameraSpec
from arcgym.sensors.camera_rays import fisheye_rays, pixel_angle
from arcgym.sensors.endoscope_camera import lights_in_camera


def test_angle_grows_with_distance_from_the_center():
    """The center of pixel (0, 0) of an N x N picture lies at 1 - 1/N of the half diagonal, hence of the half angle."""
    rays = fisheye_rays(10, 10, field_of_view=2.0)
    assert np.arccos(-rays[0, 0, 0, 2]) == pytest.approx(0.9, abs=1.0e-5)
    assert np.linalg.norm(rays, axis=-1) == pytest.approx(1.0, abs=1.0e-6)


def test_first_pixel_is_up_and_left():
    x, y, z = fisheye_rays(9, 9, field_of_view=2.0)[0, 0, 0]
    assert x < 0 < y and z < 0


@pytest.mark.parametrize("samples", [2, 4])
def test_samples_surround_the_pixel_center(samples):
    rays = fisheye_rays(8, 8, 1.5, samples)
    assert rays.shape == (8, 8, samples, 3)
    assert np.allclose(rays.mean(axis=2), fisheye_rays(8, 8, 1.5)[:, :, 0], atol=2.0e-3)


def test_pixel_angle():
    assert pixel_angle(30, 40, field_of_view=2.5) == pytest.approx(0.05)


def test_lights_in_the_camera_frame():
    """Camera looking along the link's +Z (half a turn about X): +Y of the link is −Y of the camera."""
    camera = CameraSpec((0.0, 0.0, 0.01), (1.0, 0.0, 0.0, 0.0), 2.0, (0.001, 0.6))
    lights = lights_in_camera(np.array([[0.004, 0.001, 0.01], [-0.004, 0.001, 0.008]]), camera)
    assert np.allclose(lights, [[0.004, -0.001, 0.0], [-0.004, -0.001, 0.002]], atol=1.0e-9)
