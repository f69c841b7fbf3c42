# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The wall alone, without a scope or pressed by a capsule that is held in place."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from static_force import static_force
from tiny_sim import TinySim

from arcgym.sim import ContactCfg, Simulation, WallSolverCfg

SOFT = {"youngs_modulus": 5.0e5}
FREE = {**SOFT, "anchor_stiffness": dict.fromkeys(("rectum", "sigmoid", "descending", "splenic", "transverse"), 0.0)}
HELD_RINGS = [0, 1, 2, 15, 16]
"""Rings that the tiny tube holds at its ends."""


def step_wall(sim: Simulation, steps: int) -> None:
    """Advance the wall, the scope standing still."""
    for _ in range(steps):
        sim.contact.detect(sim.nodal_pos, sim.state.body_q)
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)


def force_on_wall(sim: Simulation) -> np.ndarray:
    """Elastic, anchor and contact force on each vertex that moves [N], shape (V, 3)."""
    return static_force(sim).numpy()[:, 0]


def held(sim: Simulation) -> np.ndarray:
    return np.isin(sim.colon.wall.ring, HELD_RINGS)


def press(sim: Simulation) -> None:
    """Hold a capsule 3 mm deep in the wall, half way along the tube."""
    sim.endoscope.data.joint_pos[0] = torch.tensor([0.0179, 0.0018, 0.1, 0.0, 0.0, 0.0, 1.0])
    sim.forward()


def test_no_force_at_rest(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule")
    # Newtons against an element stiffness of the order of E * 10 mm = 5e4 N/m.
    assert np.abs(force_on_wall(sim)).max() < 5e-3


def test_turning_the_whole_wall_gives_no_elastic_force(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon=FREE)
    x, y, z = sim.colon.data.nodal_pos_w.unbind(-1)
    sim.colon.data.nodal_pos_w.copy_(torch.stack([-z, y, x], dim=-1))  # a quarter turn about Y
    assert np.abs(force_on_wall(sim)).max() < 1e-3


def test_anchors_pull_back_by_their_share_of_the_ring(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon={"anchor_stiffness": {"rectum": 800.0}})
    sim.colon.data.nodal_pos_w[..., 0] += 0.001
    ring_3 = sim.colon.wall.ring == 3  # the first one that moves, 37.5 mm in, still in the rectum
    # Moved as a whole the wall is unstrained; 800 N/m^2 * 12.5 mm of tube * 1 mm = 10 mN.
    assert force_on_wall(sim)[ring_3].sum(axis=0) == pytest.approx([-0.010, 0.0, 0.0], abs=5e-4)


def test_anchors_of_a_solid_sit_on_the_outer_layer(tiny_sim: TinySim) -> None:
    colon = tiny_sim("capsule", colon={"wall_model": "solid"}).colon
    springs, layer = colon.anchor_springs().stiffness, colon.wall.layer
    assert not springs[layer == 0].any() and springs[layer == 1].all()


@pytest.mark.parametrize("coarse", [True, False])
def test_a_displaced_wall_comes_back_to_rest(tiny_sim: TinySim, coarse: bool) -> None:
    wall = WallSolverCfg(coarse_correction=coarse, iterations=1 if coarse else 20)
    sim = tiny_sim("capsule", colon=SOFT, wall=wall)
    mobile = torch.from_numpy(~held(sim))
    sim.colon.data.nodal_pos_w[:, mobile, 0] += 0.002
    step_wall(sim, 240)
    assert sim.colon.data.nodal_displacement.max() < 2e-5


def test_held_vertices_never_move(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon=SOFT)
    press(sim)
    step_wall(sim, 20)
    moved = sim.colon.data.nodal_displacement[0].numpy()
    assert (moved[held(sim)] == 0.0).all()
    assert moved[~held(sim)].max() > 1e-4


@pytest.mark.parametrize(("speed", "way"), [(0.2, 0.2), (3.0, 0.5)])
def test_inertia_carries_a_wall_on_up_to_its_largest_speed(tiny_sim: TinySim, speed: float, way: float) -> None:
    sim = tiny_sim(
        "capsule", colon=FREE, wall=WallSolverCfg(largest_speed=0.5, drag=0.0, iterations=1, largest_move=1e-9)
    )
    mobile = ~held(sim)
    sim.colon.data.nodal_vel_w[:, torch.from_numpy(mobile), 0] = speed
    step_wall(sim, 1)  # solved, but hardly corrected: it goes where inertia takes it
    moved = sim.colon.data.nodal_displacement[0].numpy()[mobile]
    assert moved == pytest.approx(way * sim.physics_dt, abs=1e-6)


def test_nothing_moves_beyond_mobile_until(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon={**SOFT, "mobile_until": 0.1})
    press(sim)
    step_wall(sim, 20)
    moved = sim.colon.data.nodal_displacement[0].numpy()
    ring = sim.colon.wall.ring
    assert (moved[ring > 8] == 0.0).all()  # ring 8 lies at 100 mm
    assert moved[ring == 8].max() > 0.0


def pressed(tiny_sim: TinySim, steps: int, **wall: object) -> tuple[np.ndarray, np.ndarray]:
    """Place [m] and force [N] of every vertex after pressing for ``steps`` steps, with a contact that hardly gives."""
    hard = ContactCfg(friction=0.0, tissue_share=0.0)
    sim = tiny_sim("capsule", colon=SOFT, wall=WallSolverCfg(**wall), contact=hard)
    press(sim)
    step_wall(sim, steps)
    return sim.nodal_pos.numpy()[:, 0], force_on_wall(sim)


def test_coarse_correction_leaves_the_equilibrium_where_it_is(tiny_sim: TinySim) -> None:
    two_level, residual_force = pressed(tiny_sim, 200)
    plain, _ = pressed(tiny_sim, 800, coarse_correction=False, iterations=10)
    rest = tiny_sim("capsule").nodal_pos.numpy()[:, 0]
    moved = np.linalg.norm(plain - rest, axis=1).max()
    assert moved > 1e-3
    assert np.linalg.norm(two_level - plain, axis=1).max() < 0.01 * moved
    assert np.abs(residual_force).max() < 0.01


def test_coarse_correction_gets_there_in_fewer_steps(tiny_sim: TinySim) -> None:
    end, _ = pressed(tiny_sim, 200)
    errors = [
        np.linalg.norm(pressed(tiny_sim, 10, coarse_correction=coarse, largest_speed=2.0)[0] - end, axis=1).max()
        for coarse in (True, False)
    ]
    assert errors[0] < 0.5 * errors[1]


def test_a_step_prepared_while_the_scope_moves_is_the_same_step(tiny_sim: TinySim) -> None:
    apart, at_once = (tiny_sim("capsule", colon=SOFT) for _ in range(2))
    for sim in (apart, at_once):
        press(sim)
        step_wall(sim, 3)
        sim.contact.detect(sim.nodal_pos, sim.state.body_q)
    before = apart.nodal_pos.numpy().copy()
    apart.wall.prepare(apart.nodal_pos, apart.nodal_vel)
    np.testing.assert_array_equal(apart.nodal_pos.numpy(), before)
    for sim in (apart, at_once):
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)
    np.testing.assert_array_equal(apart.nodal_pos.numpy(), at_once.nodal_pos.numpy())
    assert np.abs(apart.nodal_pos.numpy() - before).max() > 0.0
