# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Anchor springs with slack, world by world, on the tiny tube: 17 rings 12.5 mm apart, sigmoid from 40 to 80 mm."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.assets.colon import Colon
from arcgym.sim import Simulation

MIDDLE = 5
"""Ring half way along the sigmoid colon: the third of its rings 4, 5, 6 from 50 to 75 mm is the second."""
SLACK = 0.02
MESENTERY = {
    "material": "in_situ",
    "anchor_stiffness": {"sigmoid": 3000.0},
    "anchor_slack": {"sigmoid": SLACK},
}
"""3000 N/m^2 when tight, 30 N/m^2 before: a loose share of 1 %."""


def pull_at(sim: Simulation, shift: float, world: int = 0) -> float:
    """Net pull of the middle ring's anchors when the whole wall is moved sideways [N]."""
    data = sim.colon.data
    data.nodal_pos_w.copy_(data.default_nodal_state_w[..., :3])
    data.nodal_pos_w[world, :, 0] += shift
    sim.wall_readout.clear()
    sim.wall_readout.measure(sim.nodal_pos)
    return float(data.anchor_tension[world, MIDDLE])


def test_pull_is_small_within_the_slack_and_grows_steeply_beyond(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon=MESENTERY)
    assert pull_at(sim, 0.01) == pytest.approx(30.0 * 0.0125 * 0.01, rel=1e-3)
    assert pull_at(sim, SLACK) == pytest.approx(30.0 * 0.0125 * SLACK, rel=1e-3)
    assert pull_at(sim, SLACK + 0.005) == pytest.approx(0.0125 * (30.0 * SLACK + 3000.0 * 0.005), rel=1e-3)


def test_slack_tapers_to_the_ends_of_its_segment(tiny_sim: TinySim) -> None:
    colon = Colon(tiny_sim.colon_cfg(**MESENTERY))
    slack = colon.anchor_springs().slack
    # The sigmoid's rings 4, 5 and 6 lie at 0, 1/2 and 1 of their segment.
    for ring, expected in ((4, 0.0), (5, SLACK), (6, 0.0)):
        np.testing.assert_allclose(slack[colon.wall.ring == ring], expected, atol=1e-9)


def test_without_slack_the_springs_are_linear(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon={"anchor_stiffness": {"sigmoid": 800.0}})
    assert pull_at(sim, 0.03) == pytest.approx(3.0 * pull_at(sim, 0.01), rel=1e-4)
    assert pull_at(sim, 0.01) == pytest.approx(800.0 * 0.0125 * 0.01, rel=1e-3)


def test_each_world_has_its_own_anchors(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", num_envs=3)
    sim.colon.write_anchor_scale_to_sim(torch.tensor([0.5, 4.0]), [0, 2])
    sparse, default, dense = (pull_at(sim, 0.01, world) for world in range(3))
    assert sparse == pytest.approx(0.5 * default, rel=1e-4)
    assert dense == pytest.approx(4.0 * default, rel=1e-4)


@pytest.mark.parametrize(("name", "scale"), [("sparse", 0.5), ("default", 1.0), ("dense", 1.75)])
def test_anchors_are_configured_by_name(tiny_sim: TinySim, name: str, scale: float) -> None:
    assert tiny_sim("capsule", colon={"anchors": name}).anchor_scale.tolist() == [scale]


def test_unknown_anchors_are_named(tiny_sim: TinySim) -> None:
    with pytest.raises(TypeError, match=r"'ColonCfg.anchors' .* got str 'loose'. Available: default, dense, sparse"):
        Colon(tiny_sim.colon_cfg(anchors="loose"))


def test_plain_newton_refuses_slack(tiny_sim: TinySim) -> None:
    with pytest.raises(ValueError, match="no anchors with slack; choose material='paper'"):
        tiny_sim("capsule", colon=MESENTERY, solver="newton")


def settle(sim: Simulation, steps: int) -> None:
    for _ in range(steps):
        sim.contact.detect(sim.nodal_pos, sim.state.body_q)
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)


def test_a_tight_mesentery_draws_the_wall_back_to_its_slack(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon=MESENTERY)
    data = sim.colon.data
    along = data.nodal_pos_w[..., 2] / 0.2
    moving = torch.tensor(sim.colon.mobile())
    data.nodal_pos_w[..., 1] += moving * 1.5 * SLACK * torch.sin(torch.pi * along) ** 2
    settle(sim, 480)
    assert torch.isfinite(data.nodal_pos_w).all()
    assert data.nodal_displacement.max() < SLACK


def press(sim: Simulation) -> None:
    """Hold a capsule 3 mm deep in the wall of every world, half way along the tube."""
    sim.endoscope.data.joint_pos[:] = torch.tensor([0.0179, 0.0018, 0.1, 0.0, 0.0, 0.0, 1.0])
    sim.forward()


def test_one_world_can_be_held_rigid_and_let_go(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", num_envs=2, colon={"youngs_modulus": 5.0e5})
    sim.colon.write_rigid_to_sim(torch.tensor([True]), [1])
    press(sim)
    settle(sim, 10)
    moved = sim.colon.data.nodal_displacement.amax(dim=1)
    assert moved[0] > 1e-4 and moved[1] == 0.0
    sim.colon.write_rigid_to_sim(torch.tensor([False]), [1])
    settle(sim, 10)
    assert sim.colon.data.nodal_displacement[1].max() > 1e-4


def test_a_rigid_colon_launches_no_kernel_of_the_wall(tiny_sim: TinySim, monkeypatch: pytest.MonkeyPatch) -> None:
    sim = tiny_sim("capsule", colon={"rigid": True})
    press(sim)
    monkeypatch.setattr(wp, "launch", lambda *args, **kwargs: pytest.fail("a kernel was launched"))
    sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)
