# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact of the wall with itself: a hairpin of 12 mm radius, its limbs 40 mm from axis to axis, drawn together."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from hairpin import COLON, LOWER, UPPER, HairpinSim, draw_together, of_rings, step_wall, two_tubes
from tiny_sim import own_patients

from arcgym.sim import Simulation, WallSolverCfg
from arcgym.sim.contact.self_contact import SelfContact


@pytest.fixture(scope="module")
def sim_in(tmp_path_factory: pytest.TempPathFactory) -> HairpinSim:
    return HairpinSim(tmp_path_factory.mktemp("hairpin"))


def distance_of_limbs(sim: Simulation) -> float:
    y = sim.colon.data.nodal_pos_w[0, :, 1]
    return float(y[of_rings(sim, UPPER)].min() - y[of_rings(sim, LOWER)].max())


def push(sim: Simulation) -> np.ndarray:
    """Self-contact on each vertex where it is now [N], shape (V, 3)."""
    contact = sim.wall.self_contact.measure(sim.nodal_pos)
    plane, stiffness = contact.plane.numpy()[:, 0], contact.stiffness.numpy()[:, 0]
    along = plane[:, 3] - stiffness * (plane[:, :3] * sim.nodal_pos.numpy()[:, 0]).sum(axis=1)
    return np.where(stiffness > 0.0, along, 0.0)[:, None] * plane[:, :3]


@pytest.mark.parametrize("self_contact", [True, False])
def test_limbs_drawn_together_stop_where_they_touch(sim_in: HairpinSim, self_contact: bool) -> None:
    sim = sim_in("capsule", colon=COLON, wall=WallSolverCfg(self_contact=self_contact))
    assert distance_of_limbs(sim) == pytest.approx(0.014, abs=1.0e-5)  # 40 mm less twice 12 mm of lumen and 1 of wall
    draw_together(sim, 0.025)
    step_wall(sim, 480)
    overlap = 0.002 - distance_of_limbs(sim)  # walls of 2 mm touch where their mid-surfaces are 2 mm apart
    assert overlap < 0.002 if self_contact else overlap > 0.006
    assert torch.isfinite(sim.colon.data.nodal_pos_w).all()
    assert sim.colon.data.nodal_vel_w.abs().max() < 0.01


def test_action_is_reaction(sim_in: HairpinSim) -> None:
    sim = sim_in("capsule", colon=COLON)
    draw_together(sim, 0.025)
    step_wall(sim, 480)
    force = push(sim)
    lower, upper = (force[of_rings(sim, rings).numpy(), 1].sum() for rings in (range(10), range(11, 21)))
    assert lower < -0.2 < 0.2 < upper
    assert np.abs(force.sum(axis=0)).max() < 1.0e-4 * upper


def test_rings_that_overlap_at_rest_push_only_when_closer() -> None:
    points, ring = two_tubes(0.036)
    members = np.arange(192).reshape(16, 12)
    self_contact = SelfContact(WallSolverCfg(), [points], ring, members, 0.002, own_patients(1, "cpu"), "cpu")
    # 20 mm to each side, 36 mm apart, walls of 2 mm; the mean over the facing vertices of a ring is 5 % less than 20.
    assert self_contact.rings.min_gap.numpy()[0, 15, 0] == pytest.approx(-0.004, abs=0.0001)
    for distance, pushes in ((0.036, False), (0.035, True)):
        contact = self_contact.measure(wp.array(two_tubes(distance)[0][:, None], dtype=wp.vec3, device="cpu"))
        assert contact.stiffness.numpy().any() == pushes


def test_wall_gathered_on_the_shaft_does_not_push() -> None:
    """A tube of 24 rings, pushed together to a fifth of its length with its rings at 45 degrees."""
    angle, height = np.arange(12) * np.pi / 6.0, 0.0125 * np.arange(24)
    ring = 0.02 * np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    rest = (ring + np.stack([0.0 * height, 0.0 * height, height], axis=1)[:, None]).reshape(-1, 3)
    self_contact = SelfContact(
        WallSolverCfg(),
        [rest],
        np.repeat(np.arange(24), 12),
        np.arange(288).reshape(24, 12),
        0.0,
        own_patients(1, "cpu"),
        "cpu",
    )
    gathered = rest * [1.0, 1.0, 0.2] + rest[:, [2, 2, 0]] * [0.0, 0.0, 1.0]
    contact = self_contact.measure(wp.array(gathered[:, None], dtype=wp.vec3, device="cpu"))
    assert self_contact.spheres.near.numpy().any() and not contact.stiffness.numpy().any()


def test_nothing_changes_where_nothing_touches(sim_in: HairpinSim) -> None:
    ends = []
    for self_contact in (True, False):
        sim = sim_in("capsule", colon=COLON, wall=WallSolverCfg(self_contact=self_contact))
        draw_together(sim, 0.005)
        step_wall(sim, 50)
        ends.append(sim.nodal_pos.numpy())
    assert np.array_equal(*ends)


def test_worlds_do_not_touch_each_other(sim_in: HairpinSim) -> None:
    sim = sim_in("capsule", colon=COLON, num_envs=2)
    mobile = of_rings(sim, UPPER)
    sim.colon.data.nodal_pos_w[1, mobile, 1] -= 0.05
    contact = sim.wall.self_contact.measure(sim.nodal_pos)
    touched = contact.in_contact.numpy()
    assert touched[:, 1].any() and not touched[:, 0].any()
