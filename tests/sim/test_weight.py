# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Weight of the tiny tube, 17 rings 12.5 mm apart, and of the scope in it."""

from __future__ import annotations

from typing import Any

import pytest
import torch
from tiny import TINY_SEGMENTS
from tiny_sim import TinySim, steps

from arcgym.envs import mdp
from arcgym.sim import Simulation, WeightCfg

FREE = dict.fromkeys(TINY_SEGMENTS, 0.0)
DOWN = {"supine": (1, -1.0), "prone": (1, 1.0), "left_lateral": (0, -1.0), "right_lateral": (0, 1.0)}


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("weight"))


def weighing(tube: TinySim, num_envs: int = 1, colon: dict[str, Any] | None = None, **weight: Any) -> Simulation:
    """Make worlds that weigh, with a wall like foam that is held at its ends alone."""
    cfg = {"anchor_stiffness": FREE, "youngs_modulus": 100.0, **(colon or {})}
    return tube("magnetic", num_envs=num_envs, colon=cfg, weight=WeightCfg(enabled=True, **weight))


def speed(sim: Simulation, world: int = 0, ring: int = 8) -> torch.Tensor:
    """Return the mean velocity of a ring, half way along by default."""
    return sim.colon.data.nodal_vel_w[world, torch.tensor(sim.colon.wall.ring) == ring].mean(dim=0)


def test_without_weight_nothing_of_it_is_there(tube: TinySim) -> None:
    sim = tube()
    assert sim.wall.weight is None and "gravity" not in sim.world_settings()
    with pytest.raises(ValueError, match=r"set env\.sim\.weight\.enabled=true"):
        sim.write_gravity(torch.zeros(1, 3))


def test_the_wall_rests_in_the_posture_of_its_imaging(tube: TinySim) -> None:
    sim = weighing(tube)
    sim.step(12)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-6


@pytest.mark.parametrize("posture", DOWN)
def test_a_wall_that_nothing_held_would_fall(tube: TinySim, posture: str) -> None:
    sim = weighing(tube, posture=posture, imaged="weightless", contents_per_length=0.0)
    sim.step(1)
    axis, sign = DOWN[posture]
    # In the first step nothing half way along feels the held ends yet: g times the step.
    assert speed(sim)[axis].item() == pytest.approx(sign * 9.81 * sim.physics_dt, rel=0.01)


def test_share_and_contents_add_up(tube: TinySim) -> None:
    sim = weighing(tube, posture="prone", imaged="weightless", wall_share=0.25, contents_per_length=0.5)
    sim.step(1)
    ring = torch.tensor(sim.colon.wall.ring) == 8
    mass = sim.wall.nodes.mass.numpy()[ring.numpy(), 0].sum()
    load = 0.25 + 0.5 * 0.0125 / mass  # 0.5 kg/m on 12.5 mm of a ring of this mass
    assert speed(sim)[1].item() == pytest.approx(9.81 * sim.physics_dt * load, rel=0.01)


def test_turning_takes_off_the_weight_of_the_imaging(tube: TinySim) -> None:
    sim = weighing(tube, contents_per_length=0.0)
    sim.step(4)  # a graph holds the step by now
    graph = sim._physics.recorded
    sim.write_gravity(torch.tensor([[-9.81, 0.0, 0.0]]))
    sim.step(1)
    assert sim._physics.recorded is graph and graph is not None
    # From (0, -g, 0) to (-g, 0, 0): down is to the left, and what had pulled to the back is gone.
    torch.testing.assert_close(speed(sim)[:2], torch.tensor([-1.0, 1.0]) * 9.81 * sim.physics_dt, rtol=0.01, atol=0.0)


def test_springs_bear_the_weight(tube: TinySim) -> None:
    held = dict.fromkeys(TINY_SEGMENTS, 2.0e4)
    sim = weighing(
        tube, colon={"anchor_stiffness": held}, posture="prone", imaged="weightless", contents_per_length=0.2
    )
    sim.step(steps(sim, 1.0))
    wall = torch.tensor(sim.colon.mobile())
    moved = (sim.colon.data.nodal_pos_w - sim.colon.data.default_nodal_pos_w)[0, :, 1]
    stiffness = torch.tensor(sim.wall.nodes.anchors.stiffness.numpy()[:, 0])
    borne = (stiffness * moved)[wall].sum().item()
    mass = sim.wall.nodes.mass.numpy()[:, 0]
    free = sim.colon.mobile()
    load = 9.81 * (mass[free].sum() + 0.2 * 0.0125 * len(set(sim.colon.wall.ring[free])))
    assert 0.5 * load < borne < load  # the held ends bear the rest
    assert speed(sim).norm() < 1.0e-4


def test_worlds_lie_as_they_are_told(tube: TinySim) -> None:
    sim = weighing(tube, num_envs=2, contents_per_length=0.0)
    sim.write_gravity(torch.tensor([sim.cfg.weight.gravity("prone")]), env_ids=[1])
    sim.step(1)
    assert speed(sim, 0).norm() < 1.0e-4
    assert speed(sim, 1)[1].item() == pytest.approx(2 * 9.81 * sim.physics_dt, rel=0.01)
    assert sim.world_settings()["gravity"][1].tolist() == pytest.approx([0.0, 9.81, 0.0])


def test_a_capsule_weighs(tube: TinySim) -> None:
    weights = []
    for enabled in (False, True):
        sim = tube("capsule", colon={"rigid": True}, weight=WeightCfg(enabled=enabled, posture="left_lateral"))
        sim.actuation.apply(sim.state, sim.control, sim.contact.ring, sim.physics_dt)
        weights.append(sim.state.body_f.numpy()[0, 0])
    assert weights[1] - weights[0] == pytest.approx(-0.005 * 9.81, rel=1.0e-4)  # 5 g


def test_the_event_turns_patients(tube: TinySim) -> None:
    sim = weighing(tube, num_envs=3)

    class Env:
        device = "cpu"
        random = type("", (), {"integers": staticmethod(lambda tag, low, high, env_ids: torch.tensor([1, 0]))})

    env: Any = Env()
    env.sim = sim
    mdp.change_posture(env, torch.tensor([0, 2]), postures=("left_lateral", "prone"))
    down = sim.world_settings()["gravity"] / 9.81
    torch.testing.assert_close(down, torch.tensor([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]]))


def test_what_weight_needs_is_said(tube: TinySim) -> None:
    with pytest.raises(ValueError, match=r"sim\.gravity is .* expected zeros with weight\.enabled=true"):
        tube(weight=WeightCfg(enabled=True), gravity=(0.0, 0.0, -9.81))
    with pytest.raises(ValueError, match=r"has a wall without weight: set env\.sim\.weight\.enabled=false"):
        tube(solver="newton", weight=WeightCfg(enabled=True))
