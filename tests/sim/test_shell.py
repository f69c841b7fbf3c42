# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces and stiffness of a shell of two triangles and one hinge, and of the tiny tube."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import warp as wp
from small_strain import bending_stiffness, fold_gradients, stretching_stiffness
from static_force import static_force
from tiny import tiny_colon_stage
from tiny_sim import TinySim

from arcgym.anatomy.meshing.wall import tube_triangles
from arcgym.anatomy.shell import mid_surface, wall_thickness
from arcgym.assets.materials import shell_moduli
from arcgym.assets.shell_geometry import fold_angles, polygon_factor, shell_geometry
from arcgym.sim import Simulation

SQUARE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def folded(angle: float) -> np.ndarray:
    """Return the square with vertex 3 turned out of the plane by ``angle`` about the diagonal."""
    points = SQUARE.copy()
    middle, out = np.array([0.5, 0.5, 0.0]), np.array([-0.5, 0.5, 0.0])
    points[3] = middle + np.cos(angle) * out + np.sin(angle) * np.array([0.0, 0.0, np.sqrt(0.5)])
    return points


def test_a_square_has_one_hinge_coupled_with_itself_alone() -> None:
    geometry = shell_geometry(SQUARE, TRIANGLES)
    assert sorted(geometry.hinges[0, 2:]) == [0, 2] and sorted(geometry.hinges[0, :2]) == [1, 3]
    np.testing.assert_allclose(geometry.area, 0.5)
    np.testing.assert_allclose(geometry.coupling[0, 0], 2.0 / (4 * 0.5) + 2.0 / (4 * 0.5))  # l^2 / 4A of both sides
    np.testing.assert_array_equal(geometry.coupling[0, 1:], 0.0)


def sheet(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Flat grid of ``cells`` x ``cells`` rectangles of 1 x 1.25, all diagonals the same way."""
    x, y = np.meshgrid(np.arange(cells + 1.0), 1.25 * np.arange(cells + 1.0), indexing="ij")
    points = np.stack([x, y, np.zeros_like(x)], axis=2).reshape(-1, 3)
    low = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    right, up = low + cells + 1, low + 1
    return points, np.concatenate([np.stack([low, right, right + 1], 1), np.stack([low, right + 1, up], 1)])


@pytest.mark.parametrize(
    ("bent", "energy"),
    [
        (lambda x, y: 0.5 * x**2, 1.0),
        (lambda x, y: 0.5 * y**2, 1.0),
        (lambda x, y: x * y, 2.0 * (1.0 - 0.3)),
        (lambda x, y: 0.5 * (x**2 + y**2), 2.0 * (1.0 + 0.3)),
    ],
)
def test_constant_curvature_costs_the_energy_of_a_plate(bent: Any, energy: float) -> None:
    # Twice the energy over D and area: kxx^2 + kyy^2 + 2 nu kxx kyy + 2 (1 - nu) kxy^2, with nu = 0.3.
    points, triangles = sheet(8)
    geometry = shell_geometry(points, triangles)
    slope = fold_gradients(points, geometry.hinges)[:, :, 2]
    angle = (slope * bent(points[:, 0], points[:, 1])[geometry.hinges]).sum(axis=1)
    moment = ((geometry.coupling @ [0.7, 0.3]) * angle[geometry.coupled]).sum(axis=1)
    middle = points[geometry.hinges[:, 2:], :2].mean(axis=1) / [1.0, 1.25]
    inner = ((middle >= 2.0) & (middle < 6.0)).all(axis=1)  # the hinges of 4 x 4 cells
    assert (moment * angle)[inner].sum() / (16 * 1.25) == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize("bars", [8, 12, 24])
def test_an_ovalised_polygon_has_the_energy_of_a_circle(bars: int) -> None:
    # Rigid bars keep their length under w cos 2p outwards and v sin 2p around if v tan 2d = -w tan d, d = pi / bars.
    d, p = np.pi / bars, 2 * np.pi * np.arange(bars) / bars
    out, around = np.stack([np.cos(p), np.sin(p)], 1), np.stack([-np.sin(p), np.cos(p)], 1)
    w, v = 1e-5, -1e-5 * np.tan(d) / np.tan(2 * d)
    turn = []
    for points in (out, out + w * np.cos(2 * p)[:, None] * out + v * np.sin(2 * p)[:, None] * around):
        bar = np.roll(points, -1, axis=0) - points
        turn.append(np.angle((bar[:, 0] + 1j * bar[:, 1]) / np.roll(bar[:, 0] + 1j * bar[:, 1], 1)))
    stiffness = polygon_factor(np.array([2 * d]))[0] / (2 * np.sin(d))  # D = 1 over the length of a bar
    energy = 0.5 * stiffness * ((turn[1] - turn[0]) ** 2).sum()
    assert energy == pytest.approx(0.5 * np.pi * (3 * w) ** 2, rel=1e-3)  # D / 2 int (3 w cos 2p)^2 dp


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
    points = np.concatenate([np.column_stack([ring, np.full(sectors, z)]) for z in (0.0, 0.05, 0.1)])
    geometry = shell_geometry(points, tube_triangles(3, sectors))
    moment = (geometry.coupling[..., 0] * geometry.rest_angle[geometry.coupled]).sum(axis=1)  # nu = 0
    energy = 0.5 * (moment * geometry.rest_angle).sum()
    assert energy == pytest.approx(geometry.area.sum() / (2.0 * radius**2), rel=0.02)


@pytest.fixture(scope="module")
def sim(tiny_sim: TinySim) -> Simulation:
    return tiny_sim("capsule", colon={"youngs_modulus": 5.0e5})


def elastic_force(sim: Simulation, points: np.ndarray) -> np.ndarray:
    """Force of the wall's elements at ``points`` [N], shape (V, 3), without anchors and inertia."""
    x = wp.array(points[:, None].astype(np.float32), dtype=wp.vec3, device="cpu")
    out = static_force(sim, x)
    nodes = sim.wall.nodes
    anchors = nodes.anchors.stiffness.numpy() * (points - nodes.anchors.rest.numpy()[:, 0])
    return out.numpy()[:, 0] + anchors


def test_kernel_force_is_minus_stiffness_times_small_displacement(sim: Simulation) -> None:
    shell = sim.colon.wall
    geometry = shell_geometry(shell.points, shell.triangles)
    moduli = sim.colon.moduli(*sim.colon.elasticity())
    shear, dilation = stretching_stiffness(shell.points, geometry)
    mu, lam, rigidity = moduli
    bending = bending_stiffness(shell.points, geometry, nu=lam / (lam + 2.0 * mu))
    move = 1e-6 * np.random.default_rng(0).normal(size=shell.points.shape)
    expected = np.zeros_like(move)
    np.add.at(
        expected, shell.triangles, -np.einsum("taibj,tbj->tai", mu * shear + lam * dilation, move[shell.triangles])
    )
    others = move[geometry.hinges[geometry.coupled]]
    np.add.at(expected, geometry.hinges, -rigidity * np.einsum("hkaibj,hkbj->hai", bending, others))
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
