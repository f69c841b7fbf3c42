# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The bricks of large displacements behind the indentation's reference, against textbook cases."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arcgym.benchmarks.fidelity.solid_indentation import QuarterTube, Solid
from arcgym.benchmarks.fidelity.tube_model import TubeModel

TUBE = QuarterTube(0.1, 0.02, 0.002, around=8, along=3)


def test_a_stretched_tube_bears_the_neo_hookean_stress() -> None:
    """Without contraction (ratio 0, so lambda 0), P = mu (L - 1 / L) along the tube, over a quarter of its section."""
    points = TUBE.nodes().reshape(-1, 3)
    force, _ = Solid(points, TUBE.bricks(), 5.0e6, 0.0).balance(points * np.array([1.0, 1.0, 1.3]))
    section = math.pi * (0.022**2 - 0.020**2) / 2.0  # half the circle, one end
    pull = force[points[:, 2] > 0.05 - 1.0e-9, 2].sum()
    assert pull == pytest.approx(2.5e6 * (1.3 - 1.0 / 1.3) * section, rel=2e-3)


def test_turning_the_tube_takes_no_force() -> None:
    points = TUBE.nodes().reshape(-1, 3)
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    force, _ = Solid(points, TUBE.bricks(), 5.0e6, 0.49).balance(points @ turn.T)
    assert np.abs(force).max() < 1.0e-6


def test_the_tangent_is_the_slope_of_the_forces() -> None:
    points = TUBE.nodes().reshape(-1, 3)
    solid, noise = Solid(points, TUBE.bricks(), 5.0e6, 0.4), np.random.default_rng(0)
    bent, way = points * 1.05, noise.normal(size=points.shape)
    slope = (solid.balance(bent + 1.0e-8 * way)[0] - solid.balance(bent - 1.0e-8 * way)[0]).ravel() / 2.0e-8
    assert solid.balance(bent)[1] @ way.ravel() == pytest.approx(slope, rel=1e-3, abs=1e-6 * np.abs(slope).max())


def test_small_strains_are_those_of_the_linear_bricks() -> None:
    tube = TubeModel(0.1, 0.02, 0.002, 5.0e6, 0.45, around=8, along=4)
    linear, large = tube.stiffness(), Solid(tube.points(), tube.bricks(), 5.0e6, 0.45).balance(tube.points())[1]
    assert abs(linear - large).max() < 1.0e-9 * abs(linear).max()


def test_inner_areas_add_up() -> None:
    _, area = TUBE.inside()
    assert area.sum() == pytest.approx(math.pi * 0.02 * 0.05)
