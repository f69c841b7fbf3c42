# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Distances from a square of two triangles, and samples spread over it."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.validation.surface_distance import distance_to_surface, surface_samples

SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_distances_to_inside_edge_and_corner() -> None:
    places = np.array([[1.0, 0.5, 0.3], [3.0, 1.0, 0.0], [5.0, 6.0, 0.0], [0.4, 1.5, 0.0]])
    assert distance_to_surface(places, SQUARE, FACES) == pytest.approx([0.3, 1.0, 5.0, 0.0], abs=1e-6)


def test_samples_lie_on_the_surface_as_often_everywhere() -> None:
    samples = surface_samples(SQUARE, FACES, 4000)
    assert samples.shape == (4000, 3) and (samples[:, 2] == 0.0).all()
    assert ((samples >= 0.0) & (samples <= 2.0)).all()
    quarter = ((samples[:, 0] < 1.0) & (samples[:, 1] < 1.0)).mean()  # a quarter of them, give or take five sigma
    assert quarter == pytest.approx(0.25, abs=5 * np.sqrt(0.25 * 0.75 / 4000))
