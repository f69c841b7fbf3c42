# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What commands do to a scope that touches nothing, and how far the drives go when it is blocked."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from tiny_sim import TinySim, steps

from arcgym.assets import IntroducerCfg, TipPullCfg
from arcgym.sim import Simulation
from arcgym.utils.math import quat_apply


def values(sim: Simulation, *numbers: float) -> list[torch.Tensor]:
    return [torch.full((sim.num_envs,), number) for number in numbers]


def push(sim: Simulation, velocity: float = 0.0, roll_rate: float = 0.0, seconds: float = 0.1) -> None:
    sim.endoscope.set_insertion_command(*values(sim, velocity, roll_rate))
    sim.step(steps(sim, seconds))


def bend(sim: Simulation, pitch: float, yaw: float, seconds: float) -> None:
    sim.endoscope.set_bending_command(*values(sim, pitch, yaw))
    sim.step(steps(sim, seconds))


def inside(tiny_sim: TinySim) -> Simulation:
    """Return a scope with its bending section in the lumen, clear of the introducer and of the wall."""
    sim = tiny_sim()
    push(sim, 0.1, seconds=0.5)
    push(sim, 0.0)
    return sim


def forward(sim: Simulation) -> torch.Tensor:
    """Direction that the tip looks in, shape (3,)."""
    return quat_apply(sim.endoscope.data.tip_quat_w, torch.tensor([[0.0, 0.0, 1.0]]))[0]


def test_insertion_follows_the_commanded_speed(tiny_sim: TinySim) -> None:
    sim = tiny_sim()
    push(sim, 0.05, seconds=0.3)
    before = sim.endoscope.data.inserted_length.clone()
    push(sim, 0.05, seconds=0.4)
    assert (sim.endoscope.data.inserted_length - before).item() == pytest.approx(0.02, rel=0.01)


def test_withdrawal_follows_the_commanded_speed(tiny_sim: TinySim) -> None:
    sim = tiny_sim()
    push(sim, 0.05, seconds=0.5)
    push(sim, -0.05, seconds=0.2)
    before = sim.endoscope.data.inserted_length.clone()
    push(sim, -0.05, seconds=0.2)
    assert (sim.endoscope.data.inserted_length - before).item() == pytest.approx(-0.01, rel=0.01)


def test_the_base_stops_at_the_anus(tiny_sim: TinySim) -> None:
    sim = tiny_sim()
    push(sim, 0.1, seconds=1.5)
    stage = sim.endoscope.stage
    assert sim.endoscope.data.inserted_length.item() == pytest.approx(
        stage.total_length - stage.link_length[0], abs=5e-4
    )


def block(sim: Simulation) -> None:
    """Narrow the tube around the tip to nothing, so that the scope cannot go on."""
    wall = sim.colon.wall
    ahead = torch.from_numpy(wall.ring_arc[wall.ring] > 0.045)
    sim.colon.data.nodal_pos_w[:, ahead, :2] *= 0.1


def test_push_never_exceeds_the_force_limit(tiny_sim: TinySim) -> None:
    sim = tiny_sim(colon={"mobile_until": 0.0}, scope={"drives": {"base": {"force_limit": 3.0}}})
    block(sim)
    push(sim, 0.05, seconds=1.0)
    pushes = []
    for _ in range(5):
        push(sim, 0.05, seconds=0.1)
        pushes.append(sim.endoscope.data.base_force.item())
    assert max(pushes) <= 3.0 + 1e-4
    assert pushes[-1] > 2.5  # it does push


def test_a_blocked_scope_withdraws_at_once(tiny_sim: TinySim) -> None:
    sim = tiny_sim(colon={"mobile_until": 0.0}, scope={"drives": {"base": {"force_limit": 3.0}}})
    block(sim)
    push(sim, 0.05, seconds=1.5)
    before = sim.endoscope.data.inserted_length.item()
    push(sim, -0.05, seconds=0.3)
    assert sim.endoscope.data.inserted_length.item() < before - 0.01


def test_bending_moves_at_its_rate(tiny_sim: TinySim) -> None:
    sim = tiny_sim(scope={"drives": {"bending": {"rate": 0.5}}})
    bend(sim, 1.0, 0.0, seconds=0.4)
    assert sim.endoscope.data.bending[0, 0].item() == pytest.approx(0.2, rel=1e-3)


def test_bending_reaches_the_command(tiny_sim: TinySim) -> None:
    sim = inside(tiny_sim)
    bend(sim, 0.3, -0.2, seconds=1.0)
    torch.testing.assert_close(sim.endoscope.data.bending, torch.tensor([[0.3, -0.2]]))
    bends = sim.endoscope.stage.bend_coords[-3:]  # hinges 3, 4 and 5
    pitch, yaw = sim.endoscope.data.joint_pos[0, bends].sum(dim=0).tolist()
    assert pitch == pytest.approx(0.3, rel=0.01)
    assert yaw == pytest.approx(-0.2, rel=0.01)


def test_bending_stops_at_the_limits(tiny_sim: TinySim) -> None:
    sim = tiny_sim(scope={"drives": {"bending": {"rate": 20.0}}})
    bend(sim, 9.0, -9.0, seconds=0.5)
    limit = sim.endoscope.stage.hinge_limit[-3:]
    expected = torch.tensor(limit.sum(axis=0) * [1.0, -1.0], dtype=torch.float32)[None]
    torch.testing.assert_close(sim.endoscope.data.bending, expected)


def test_pitch_turns_the_tip_about_x(tiny_sim: TinySim) -> None:
    sim = inside(tiny_sim)
    bend(sim, 0.3, 0.0, seconds=1.0)
    # Right-handed about +X: +Z turns towards -Y.
    x, y, _ = forward(sim)
    assert y.item() == pytest.approx(-0.2955, abs=0.003) and abs(x.item()) < 1e-3


def test_yaw_turns_the_tip_about_y(tiny_sim: TinySim) -> None:
    sim = inside(tiny_sim)
    bend(sim, 0.0, 0.2, seconds=1.0)
    # Right-handed about +Y: +Z turns towards +X.
    x, y, _ = forward(sim)
    assert x.item() == pytest.approx(0.1987, abs=0.003) and abs(y.item()) < 1e-3


def test_roll_turns_a_bent_tip_about_the_shaft(tiny_sim: TinySim) -> None:
    sim = tiny_sim()
    bend(sim, 0.0, 0.2, seconds=0.6)
    push(sim, roll_rate=0.5, seconds=1.0)
    push(sim, roll_rate=0.0, seconds=0.5)
    x, y, _ = forward(sim)
    assert torch.atan2(y, x).item() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("kind", ["capsule", "magnetic"])
def test_pulled_tip_follows_the_commanded_speed(tiny_sim: TinySim, kind: str) -> None:
    sim = tiny_sim(kind)
    velocity = torch.tensor([[0.0, 0.0, 0.05]])
    sim.endoscope.set_tip_velocity_command(velocity, torch.zeros(1, 3))
    sim.step(steps(sim, 0.2))
    before = sim.endoscope.data.tip_pos_w.clone()
    sim.step(steps(sim, 0.4))
    moved = (sim.endoscope.data.tip_pos_w - before)[0]
    torch.testing.assert_close(moved, torch.tensor([0.0, 0.0, 0.02]), rtol=0.05, atol=1e-4)


def test_pulled_capsule_turns_at_the_commanded_rate(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule")
    sim.endoscope.data.joint_pos[0, 2] = 0.1
    sim.forward()
    sim.endoscope.set_tip_velocity_command(torch.zeros(1, 3), torch.tensor([[0.0, 0.5, 0.0]]))
    sim.step(steps(sim, 1.0))
    x, y, _ = forward(sim)
    assert x.item() == pytest.approx(0.4794, abs=0.03) and abs(y.item()) < 0.01  # sin 0.5


def test_pull_never_exceeds_its_limit(tiny_sim: TinySim) -> None:
    sim = tiny_sim("magnetic", colon={"mobile_until": 0.0})
    block(sim)
    sim.endoscope.set_tip_velocity_command(torch.tensor([[0.0, 0.0, 0.05]]), torch.zeros(1, 3))
    sim.step(steps(sim, 1.5))
    sim.step(steps(sim, 0.1))
    pull = torch.linalg.vector_norm(sim.endoscope.data.tip_pull_force_w).item()
    assert 3.5 < pull <= 4.0 + 1e-4


def sideways(sim: Simulation) -> float:
    """Largest distance from the Z axis [m] of what is outside the anus, after a push against a closed lumen."""
    block(sim)
    sim.endoscope.data.joint_pos[0, 2:] = 0.01  # not quite straight
    sim.forward()
    push(sim, 0.05, seconds=1.2)
    place = sim.endoscope.data.body_pos_w[0]
    return torch.linalg.vector_norm(place[place[:, 2] < 0.0][:, :2], dim=1).max().item()


def test_introducer_keeps_the_shaft_outside_straight(tiny_sim: TinySim) -> None:
    # 0.1 m of a limp shaft: Euler load pi^2 * 0.005 N m^2 / (0.1 m)^2 = 5 N if its ends are guided, less if not.
    limp = {"shaft_rigidity": 0.005, "drives": {"base": {"force_limit": 6.0}}}
    guided, free = (
        sideways(tiny_sim("proximal", 12, colon={"mobile_until": 0.0}, scope={"introducer": guide, **limp}))
        for guide in (IntroducerCfg(), IntroducerCfg(stiffness_per_length=0.0))
    )
    assert guided < 0.005 < 0.015 < free


def test_gravity_weighs_the_real_masses(tiny_sim: TinySim) -> None:
    loose = {"actuators": {"tip": TipPullCfg(stiffness=1.0, damping=0.0)}}
    sim = tiny_sim("capsule", scope=loose, gravity=(0.0, 0.0, -9.81), mass_scaling=3.0)
    sim.endoscope.data.joint_pos[0, 2] = 0.1
    sim.forward()
    sim.step(1)
    # The weight is real, the inertia three times as large: a third of g.
    speed = sim.endoscope.data.body_lin_vel_w[0, 0, 2].item()
    assert speed == pytest.approx(-9.81 / 3.0 * sim.physics_dt, rel=0.01)


@pytest.mark.parametrize(("lower", "lift"), [(0.005, 0.0), (0.03, 20.0), (0.08, 0.0)])
def test_a_loop_that_comes_out_of_the_anus_is_lifted(tiny_sim: TinySim, lower: float, lift: float) -> None:
    sim = tiny_sim("proximal", 12)
    low = int(np.argmin(np.abs(sim.endoscope.rest_height + 0.05)))
    sim.endoscope.data.body_pos_w[0, low, 2] -= lower
    sim.actuation.apply(sim.state, sim.control, sim.contact.ring, sim.physics_dt)
    # A link of 25 mm has 1000 N/m on what is lower by more than 10 mm than in a straight shaft.
    assert sim.state.body_f.numpy()[low, 2] == pytest.approx(lift, abs=0.1)


def test_a_capsule_does_not_fall_out(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule")
    sim.endoscope.set_tip_velocity_command(torch.tensor([[0.0, 0.0, -0.05]]), torch.zeros(1, 3))
    sim.step(steps(sim, 1.0))
    # A pull of 1 N against 40 kN/m^2 * 20 mm = 800 N/m below half its cylinder's length, 5 mm.
    assert sim.endoscope.data.root_pos_w[0, 2].item() == pytest.approx(0.005 - 0.00125, abs=2e-4)


@pytest.mark.parametrize("links", [12, 24])
def test_the_introducer_is_as_stiff_whatever_the_links(tiny_sim: TinySim, links: int) -> None:
    sim = tiny_sim("proximal", links)
    height = sim.endoscope.rest_height
    sim.endoscope.data.body_pos_w[0, :, 0] += 0.001
    sim.actuation.apply(sim.state, sim.control, sim.contact.ring, sim.physics_dt)
    pull = -sim.state.body_f.numpy()[1:, 0].sum()
    end = height[1] - 0.5 * sim.endoscope.stage.link_length[1]
    assert pull == pytest.approx(4.0e4 * 0.001 * (0.005 - end), rel=1e-3)  # the shaft behind the base, up to 5 mm
