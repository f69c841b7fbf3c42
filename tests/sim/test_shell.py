# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces and stiffness of a shell of two triangles and one hinge, and of the tiny tube."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from tiny import tiny_colon_stage
from tiny_sim import TinySim

from arcgym.anatomy.shell import mid_surface, wall_thickness
from arcgym.assets.materials import shell_moduli
from arcgym.assets.shell_geometry import fold_angles, fold_gradients, shell_geometry
from arcgym.sim import Simulation
from arcgym.sim.wall.shell_elements import bending_stiffness, stretching_stiffness

SQUARE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def folded(angle: float) -> np.ndarray:
    """Return the square with vertex 3 turned out of the plane by ``angle`` about the diagonal."""
    points = SQUARE.copy()
    middle, out = np.array([0.5, 0.5, 0.0]), np.array([-0.5, 0.5, 0.0])
    points[3] = middle + np.cos(angle) * out + np.sin(angle) * np.array([0.0, 0.0, np.sqrt(0.5)])
    return points


def test_a_square_has_one_hinge_of_weight_c_3_l2_over_areas() -> None:
    geometry = shell_geometry(SQUARE, TRIANGLES)
    assert sorted(geometry.hinges[0, 2:]) == [0, 2] and sorted(geometry.hinges[0, :2]) == [1, 3]
    np.testing.assert_allclose(geometry.area, 0.5)
    from arcgym.assets.shell_geometry import BENDING_WEIGHT

    np.testing.assert_allclose(geometry.weight, BENDING_WEIGHT * 3.0 * 2.0 / 1.0)


@pytest.mark.parametrize("angle", [-0.7, 0.0, 0.4])
def test_fold_angle_is_the_turn_about_the_edge(angle: float) -> None:
    hinges = shell_geometry(SQUARE, TRIANGLES).hinges
    assert abs(fold_angles(folded(angle), hinges)[0]) == pytest.approx(abs(angle))


def test_fold_gradient_is_the_difference_quotient() -> None:
    hinges, points = shell_geometry(SQUARE, TRIANGLES).hinges, folded(0.4)
    gradient, h = fold_gradients(points, hinges)[0], 1e-6
    for corner, vertex in enumerate(hinges[0]):
        for axis in range(3):
            moved = [points.copy(), points.copy()]
            moved[0][vertex, axis] -= h
            moved[1][vertex, axis] += h
            low, high = (fold_angles(p, hinges)[0] for p in moved)
            assert gradient[corner, axis] == pytest.approx((high - low) / (2 * h), abs=1e-6)


def test_stretching_a_square_costs_the_plane_stress_energy() -> None:
    # A strain of e along X alone: energy (2 mu + lambda) e^2 / 2 times the area of 1.
    geometry = shell_geometry(SQUARE, TRIANGLES)
    shear, dilation = stretching_stiffness(SQUARE, geometry)
    moved = (SQUARE * [1.0, 0.0, 0.0])[TRIANGLES]
    for stiffness, expected in ((shear, 2.0), (dilation, 1.0)):
        assert np.einsum("tai,taibj,tbj", moved, stiffness, moved) == pytest.approx(expected)


def test_plane_stress_moduli_give_back_youngs_modulus() -> None:
    # Free to contract sideways, stiffness is (2 mu + lambda) - lambda^2 / (2 mu + lambda) = E t.
    mu, lam, rigidity = shell_moduli(2.0e6, 0.4, 0.003)
    assert (2 * mu + lam) - lam**2 / (2 * mu + lam) == pytest.approx(2.0e6 * 0.003)
    assert rigidity == pytest.approx(2.0e6 * 0.003**3 / (12 * (1 - 0.16)))


def test_bending_a_cylinder_costs_half_d_over_r_squared_per_area() -> None:
    # Rolled up from flat, a strip of length 1 on a circle of radius R has the energy D / (2 R^2) an area.
    sectors, radius = 64, 0.5
    angle = np.arange(sectors) * 2 * np.pi / sectors
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)
    points = np.concatenate([np.column_stack([ring, np.full(sectors, z)]) for z in (0.0, 0.05)])
    near, after = np.arange(sectors), (np.arange(sectors) + 1) % sectors
    triangles = np.concatenate(
        [np.stack([near, after, sectors + near], 1), np.stack([after, sectors + after, sectors + near], 1)]
    )
    geometry = shell_geometry(points, triangles)
    energy = 0.5 * (geometry.weight * geometry.rest_angle**2).sum()
    expected = geometry.area.sum() / (2.0 * radius**2)
    assert energy == pytest.approx(expected, rel=0.1)  # the weight is calibrated: 0.36 for 1/3


@pytest.fixture(scope="module")
def sim(tiny_sim: TinySim) -> Simulation:
    return tiny_sim("capsule", colon={"youngs_modulus": 5.0e5})


def elastic_force(sim: Simulation, points: np.ndarray) -> np.ndarray:
    """Force of the wall's elements at ``points`` [N], shape (V, 3), without anchors and inertia."""
    x = wp.array(points[:, None].astype(np.float32), dtype=wp.vec3, device="cpu")
    out = sim.wall.static_force(x, sim.contact, sim.state.body_q)
    nodes = sim.wall.nodes
    anchors = nodes.anchors.stiffness.numpy()[:, None] * (points - nodes.anchors.rest.numpy())
    return out.numpy()[:, 0] + anchors


def test_kernel_force_is_minus_stiffness_times_small_displacement(sim: Simulation) -> None:
    shell = sim.colon.wall
    geometry = shell_geometry(shell.points, shell.triangles)
    moduli = sim.colon.moduli(*sim.colon.elasticity())
    shear, dilation = stretching_stiffness(shell.points, geometry)
    bending = bending_stiffness(shell.points, geometry)
    move = 1e-6 * np.random.default_rng(0).normal(size=shell.points.shape)
    expected = np.zeros_like(move)
    for elements, stiffness in (
        (shell.triangles, moduli[0] * shear + moduli[1] * dilation),
        (geometry.hinges, moduli[2] * bending),
    ):
        np.add.at(expected, elements, -np.einsum("taibj,tbj->tai", stiffness, move[elements]))
    rest = shell.points.astype(float)
    force = elastic_force(sim, rest + move) - elastic_force(sim, rest)
    mobile = sim.colon.mobile()
    error = np.linalg.norm((force - expected)[mobile]) / np.linalg.norm(expected[mobile])
    assert error < 0.03


def test_a_thinner_shell_keeps_the_lumen() -> None:
    wall = tiny_colon_stage().wall  # 2 mm thick, radius 20 mm
    assert wall_thickness(wall) == pytest.approx(0.002)
    radius = [np.linalg.norm(mid_surface(wall, t).points[:8, :2], axis=1) for t in (0.001, 0.002)]
    np.testing.assert_allclose(radius, [[0.0205] * 8, [0.021] * 8], rtol=1e-6)
