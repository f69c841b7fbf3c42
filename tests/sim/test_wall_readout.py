# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Strain and anchor tension of the tiny tube: radius 20 mm, 17 rings of 8 vertices, 12.5 mm apart, two worlds."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tiny import tiny_colon_stage
from tiny_sim import TinySim

from arcgym.anatomy.measures import inner_faces
from arcgym.assets.anchors import AnchorSprings
from arcgym.sim.wall.wall_readout import WallReadout, inverse_rest
from arcgym.sim.wall.wall_topology import lumen_topology

WALL = tiny_colon_stage().wall
SPRING = 10.0


@pytest.fixture
def readout() -> WallReadout:
    """Every vertex of ring 5 is held by a spring of 10 N/m, in world 1 by one of 5 N/m."""
    lumen = lumen_topology(WALL.points, inner_faces(WALL.tets, WALL.layer), WALL.ring, WALL.layer)
    anchor = AnchorSprings.linear(np.where(WALL.ring == 5, SPRING, 0.0))
    scale = wp.array([1.0, 0.5], dtype=float)
    return WallReadout(lumen, [WALL.points], WALL.ring, [anchor], scale, wp.zeros(2, dtype=int, device="cpu"), "cpu")


def positions(first: np.ndarray, second: np.ndarray) -> wp.array:
    """Positions of two worlds, shape (V, 2)."""
    return wp.array(np.stack([first, second], axis=1), dtype=wp.vec3)


def test_rest_has_neither_strain_nor_tension(readout: WallReadout) -> None:
    readout.measure(positions(WALL.points, WALL.points))
    np.testing.assert_allclose(readout.strain.numpy(), 0.0, atol=1e-5)
    np.testing.assert_allclose(readout.tension.numpy(), 0.0, atol=1e-6)


def test_stretch_along_the_tube_is_the_strain_of_its_world_alone(readout: WallReadout) -> None:
    readout.measure(positions(WALL.points * [1.0, 1.0, 1.2], WALL.points))
    strain = readout.strain.numpy()
    # The closed end, the last ring's faces, lies across the tube and does not stretch.
    np.testing.assert_allclose(strain[:-1, 0], 0.2, atol=1e-4)
    np.testing.assert_allclose(strain[:, 1], 0.0, atol=1e-5)


def test_dilation_counts_the_widest_direction(readout: WallReadout) -> None:
    readout.measure(positions(WALL.points * [1.3, 1.3, 1.1], WALL.points))
    np.testing.assert_allclose(readout.strain.numpy()[:, 0], 0.3, atol=1e-4)


def test_rotation_and_shift_are_no_strain(readout: WallReadout) -> None:
    turned = WALL.points[:, [1, 2, 0]] + np.array([0.1, -0.2, 0.3], np.float32)
    readout.measure(positions(turned, WALL.points))
    np.testing.assert_allclose(readout.strain.numpy(), 0.0, atol=1e-4)


def test_compression_counts_as_zero(readout: WallReadout) -> None:
    readout.measure(positions(0.8 * WALL.points, WALL.points))
    np.testing.assert_allclose(readout.strain.numpy()[:, 0], 0.0, atol=1e-6)


def test_anchors_pull_with_spring_times_displacement(readout: WallReadout) -> None:
    moved = WALL.points + np.array([0.003, 0.0, 0.004], np.float32)
    readout.measure(positions(moved, moved))
    # 16 vertices of ring 5 (two layers of 8), each 5 mm away: 16 * 10 N/m * 5 mm.
    expected = np.zeros((17, 2))
    expected[5] = [0.8, 0.4]
    np.testing.assert_allclose(readout.tension.numpy(), expected, atol=1e-5)


def test_a_ring_that_only_widens_pulls_evenly_and_the_sum_is_zero(readout: WallReadout) -> None:
    readout.measure(positions(WALL.points * [1.3, 1.3, 1.0], WALL.points))
    np.testing.assert_allclose(readout.tension.numpy(), 0.0, atol=1e-5)


def test_mean_and_peak_over_a_control_step(readout: WallReadout) -> None:
    for stretch in (1.0, 1.3, 1.1, 1.0):
        readout.measure(positions(WALL.points * [1.0, 1.0, stretch], WALL.points))
    readout.finish(4)
    assert readout.strain.numpy()[3, 0] == pytest.approx(0.1, abs=1e-4)
    assert readout.strain_peak.numpy()[3, 0] == pytest.approx(0.3, abs=1e-4)
    readout.clear()
    assert readout.strain_peak.numpy().max() == 0.0


def test_reset_forgets_one_world(readout: WallReadout) -> None:
    stretched = WALL.points * np.array([1.0, 1.0, 1.2], np.float32)
    readout.measure(positions(stretched, stretched))
    readout.reset(torch.tensor([0]))
    assert readout.strain.numpy()[3].tolist() == pytest.approx([0.0, 0.2], abs=1e-4)


def test_inverse_rest_of_a_right_triangle() -> None:
    corners = np.array([[[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.01, 0.0, 0.04]]])
    np.testing.assert_allclose(inverse_rest(corners), [[50.0, 0.5, 25.0]])


def test_simulation_reads_every_step_and_forgets_at_reset(tiny_sim: TinySim) -> None:
    sim = tiny_sim(num_envs=2, colon={"youngs_modulus": 5.0e5})
    data = sim.colon.data
    data.nodal_pos_w[1, :, 0] += 0.002 * (torch.tensor(sim.colon.wall.ring) == 6)
    sim.step(1)
    springs = torch.tensor(sim.colon.anchor_springs().stiffness, dtype=torch.float32)[:, None]
    pull = springs * (data.nodal_pos_w[1] - data.default_nodal_state_w[1, :, :3])
    expected = pull[torch.tensor(sim.colon.wall.ring) == 6].sum(dim=0).norm()
    assert float(expected) > 0.0
    torch.testing.assert_close(data.anchor_tension[1, 6], expected)
    torch.testing.assert_close(data.anchor_tension_peak, data.anchor_tension)
    assert data.wall_strain.shape == (2, 17) and data.wall_strain[1, 6] > 0.005 > data.wall_strain[0].max()
    sim.write_snapshot(-1, [1])
    assert data.wall_strain[1].max() == data.anchor_tension[1].max() == 0.0
