# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest stiffness of the wall, element by element and projected on the rings' affine modes."""

from __future__ import annotations

import numpy as np
import pytest
from tiny import tiny_colon_stage

from arcgym.sim.ring_modes import MODES, RingModes, element_stiffness, ring_modes

MU, LAM = 3.0, 5.0
TET = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.3, 0.1, 1.5]])


def energy(x: np.ndarray) -> float:
    """Stable neo-Hookean energy of TET deformed to x, Smith et al. 2018 with lambda + mu for lambda."""
    rest, now = (np.array([p[1] - p[0], p[2] - p[0], p[3] - p[0]]).T for p in (TET, x))
    f = now @ np.linalg.inv(rest)
    j = np.linalg.det(f)
    density = 0.5 * MU * (np.sum(f**2) - 3.0) - MU * (j - 1.0) + 0.5 * (LAM + MU) * (j - 1.0) ** 2
    return density * np.linalg.det(rest) / 6.0


def test_element_stiffness_is_the_second_difference_of_the_energy() -> None:
    k = element_stiffness(TET, np.array([[0, 1, 2, 3]]), np.array([[MU, LAM]]))[0].reshape(12, 12)
    h, steps = 1e-4, np.eye(12).reshape(12, 4, 3)
    second = np.empty((12, 12))
    for a in range(12):
        for b in range(12):
            corners = [energy(TET + h * (s * steps[a] + t * steps[b])) for s, t in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
            second[a, b] = (corners[0] - corners[1] - corners[2] + corners[3]) / (4 * h * h)
    np.testing.assert_allclose(k, second, atol=1e-5 * np.abs(k).max())


@pytest.fixture(scope="module")
def free_tube() -> tuple[np.ndarray, RingModes]:
    """Vertex masses and modes of the tiny tube with nothing held; anchors of 2 N/m at every vertex."""
    wall = tiny_colon_stage().wall
    count = len(wall.points)
    mass = np.linspace(1e-4, 2e-4, count)
    lame = np.tile([1.0e6, 4.0e6], (len(wall.tets), 1))
    held = np.zeros(count, bool)
    points = wall.points.astype(float)
    return mass, ring_modes(points, wall.tets, wall.ring, ~held, mass, np.full(count, 2.0), lame)


def assembled(modes: RingModes) -> np.ndarray:
    rings = len(modes.stiffness)
    full = np.zeros((rings, MODES, rings, MODES))
    for r in range(rings):
        full[r, :, r] = modes.stiffness[r]
        if r + 1 < rings:
            full[r, :, r + 1] = modes.coupling[r]
            full[r + 1, :, r] = modes.coupling[r].T
    return full.reshape(rings * MODES, rings * MODES)


def test_stiffness_is_symmetric_and_never_negative(free_tube: tuple) -> None:
    matrix = assembled(free_tube[1])
    values = np.linalg.eigvalsh(matrix)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
    assert values.min() > -1e-9 * values.max()


@pytest.mark.parametrize("axis", range(3))
def test_moving_all_rings_together_costs_nothing(free_tube: tuple, axis: int) -> None:
    matrix = assembled(free_tube[1])
    together = np.zeros((len(matrix) // MODES, MODES))
    together[:, 3 * axis] = 1.0
    force = matrix @ together.ravel()
    alone = matrix[:, 3 * axis]
    assert np.abs(force).max() < 1e-9 * np.abs(alone).max()


def test_mass_and_anchors_of_the_translations_sum_to_the_walls(free_tube: tuple) -> None:
    mass, modes = free_tube
    for axis in range(3):
        assert modes.mass[:, 3 * axis, 3 * axis].sum() == pytest.approx(mass.sum())
        assert modes.anchor[:, 3 * axis, 3 * axis].sum() == pytest.approx(2.0 * len(mass))


def test_held_vertices_take_no_part() -> None:
    wall = tiny_colon_stage().wall
    mobile = wall.ring > 2
    ones, lame = np.ones(len(wall.points)), np.tile([1.0e6, 4.0e6], (len(wall.tets), 1))
    modes = ring_modes(wall.points.astype(float), wall.tets, wall.ring, mobile, ones, ones, lame)
    assert not modes.mass[:3].any() and not modes.coupling[:3].any()
    np.testing.assert_array_equal(modes.stiffness[0], 1.0e3 * np.eye(MODES))


def test_rest_frames_are_rotations(free_tube: tuple) -> None:
    frames = free_tube[1].rest_frame
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (len(frames), 1, 1)), atol=1e-6)
    np.testing.assert_allclose(np.abs(frames[:, 2, 2]), 1.0, atol=1e-6)  # the straight tube runs along Z


def test_a_tet_over_three_rings_is_refused() -> None:
    wall = tiny_colon_stage().wall
    swapped = np.arange(17)
    swapped[[4, 5]] = 5, 4
    ones, lame = np.ones(len(wall.points)), np.tile([1.0e6, 4.0e6], (len(wall.tets), 1))
    with pytest.raises(ValueError, match="adjacent rings only"):
        ring_modes(wall.points.astype(float), wall.tets, swapped[wall.ring], ones > 0, ones, ones, lame)
