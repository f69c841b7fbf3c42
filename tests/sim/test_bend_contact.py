# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact of the two limbs of one bend: tubes of 12 mm radius that turn back, and are drawn together, or gathered."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
import warp as wp
from hairpin import COLON, HairpinSim, hairpin, of_rings, step_wall
from tiny_sim import own_patients, steps

from arcgym.sim import ContactCfg, LoopFrictionCfg, Simulation, WallSolverCfg
from arcgym.sim.contact.self_contact import SelfContact
from arcgym.sim.wall.surroundings import Surroundings
from arcgym.sim.wall.surroundings_kernels import measure_surroundings

RADIUS, WIDTH = 0.012, 0.032
"""Of the tube, and from limb to limb of the hairpin that is drawn together [m]."""


def straight(rings: int = 21, spacing: float = 0.01) -> np.ndarray:
    """Points of a tube along Z, 12 a ring, shape (V, 3)."""
    angle = np.arange(12) * np.pi / 6.0
    ring = RADIUS * np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    return (ring + np.arange(rings)[:, None, None] * [0.0, 0.0, spacing]).reshape(-1, 3)


def pushes(rest: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Push of bends on each vertex of a tube that rests at ``rest`` and is ``at`` now [N], shape (V, 3)."""
    count = len(rest) // 12
    ring, members = np.repeat(np.arange(count), 12), np.arange(len(rest)).reshape(count, 12)
    contact = SelfContact(WallSolverCfg(), [rest], ring, members, 0.002, own_patients(1, "cpu"), "cpu")
    groups = wp.array(members, dtype=int, device="cpu")
    around = Surroundings(ring, groups, 1, "cpu", bends=True)
    around.bind(contact, [rest])
    x = wp.array(at[:, None].astype(np.float32), dtype=wp.vec3, device="cpu")
    contact.measure(x)
    wp.launch(
        measure_surroundings,
        (count, 1),
        inputs=[x, around._around, wp.ones(1, dtype=float, device="cpu"), 1.0],
        outputs=[around.force],
        device="cpu",
    )
    force = around.force
    pull = np.einsum("vij,vj->vi", force.stiffness.numpy()[:, 0], at.astype(np.float32))
    return force.push.numpy()[:, 0] - pull


@pytest.mark.parametrize("radius", [0.85 * RADIUS, 2.0 * RADIUS])
def test_a_bend_at_rest_feels_nothing(radius: float) -> None:
    """Also one so tight that its walls cross each other on the inside."""
    bent = hairpin(straight(), 2.0 * radius)
    assert not pushes(bent, bent).any()


def test_a_bend_that_is_bent_on_feels_nothing_until_it_touches() -> None:
    assert not pushes(hairpin(straight(), 0.06), hairpin(straight(), 0.028)).any()
    assert pushes(hairpin(straight(), 0.06), hairpin(straight(), 0.02)).any()


@pytest.mark.parametrize("share", [1.0, 0.5, 0.1])
def test_a_straight_tube_feels_nothing_however_it_is_gathered(share: float) -> None:
    assert not pushes(straight(), straight() * [1.0, 1.0, share]).any()


def test_a_tube_gathered_askew_feels_nothing() -> None:
    """Rings at 45 degrees to the tube, pushed together to a fifth of their distance."""
    at = straight() * [1.0, 1.0, 0.2] + straight()[:, [2, 2, 0]] * [0.0, 0.0, 1.0]
    assert not pushes(straight(), at).any()


def test_a_tube_folded_to_a_hairpin_is_pushed_apart() -> None:
    force = pushes(straight(), hairpin(straight(), 0.02)).reshape(21, 12, 3).sum(axis=1)
    turn = np.abs(force).sum(axis=1).nonzero()[0]
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1.0e-3)  # action is reaction
    assert force[:9, 1].min() < -1.0 and force[12:, 1].max() > 1.0
    assert len(turn) > 4


@pytest.fixture(scope="module")
def sim_in(tmp_path_factory: pytest.TempPathFactory) -> HairpinSim:
    return HairpinSim(tmp_path_factory.mktemp("bends"), WIDTH)


def soft(sim_in: HairpinSim, bends: bool, **cfg: Any) -> Simulation:
    return sim_in("capsule", colon={**COLON, "youngs_modulus": 2.0e4}, loops=LoopFrictionCfg(bends=bends), **cfg)


def narrow(sim: Simulation) -> None:
    """Move the places that the anchors of rings 7 to 13, which make the turn, pull to into the plane between limbs."""
    rest, ring = wp.to_torch(sim.wall.nodes.anchors.rest)[:, 0], torch.from_numpy(sim.colon.wall.ring)
    for r in range(7, 14):
        rest[ring == r, 1] += 0.5 * WIDTH - rest[ring == r, 1].mean()


def overlap(sim: Simulation) -> float:
    """How far rings 8 and 9 reach beyond those of the other limb at the same height [m]."""
    y, ring = sim.colon.data.nodal_pos_w[0, :, 1].numpy(), sim.colon.wall.ring
    return max(float(y[ring == r].max() - y[ring == 20 - r].min()) for r in (8, 9))


@pytest.mark.parametrize("bends", [False, True])
def test_a_hairpin_drawn_together_does_not_fold_through_itself(sim_in: HairpinSim, bends: bool) -> None:
    # In one jump, tuned to this step: drawn together in a second, rings 8 and 9 rest up to 1 mm across at any step.
    sim = soft(sim_in, bends, dt=1.0 / 480.0)
    narrow(sim)
    step_wall(sim, steps(sim, 1.0))
    assert overlap(sim) < 0.0 if bends else overlap(sim) > 0.006
    assert torch.isfinite(sim.colon.data.nodal_pos_w).all() and sim.colon.data.nodal_vel_w.abs().max() < 0.01


def test_a_hairpin_at_rest_is_as_without_it(sim_in: HairpinSim) -> None:
    ends = []
    for bends in (True, False):
        sim = soft(sim_in, bends)
        shaken = np.random.default_rng(0).normal(0.0, 1.0e-4, (*sim.nodal_pos.shape, 3))
        sim.nodal_pos.assign(sim.nodal_pos.numpy() + shaken)
        step_wall(sim, 50)
        ends.append(sim.colon.data.nodal_pos_w)
    torch.testing.assert_close(*ends, rtol=0.0, atol=1.0e-7)


@pytest.mark.parametrize("contact", [ContactCfg(search_reach=3), ContactCfg()], ids=["three_rings", "default"])
def test_the_wall_of_the_other_limb_is_held_off_a_link(sim_in: HairpinSim, contact: ContactCfg) -> None:
    """A limb that is drawn across the other, through whose wall it comes as nothing holds it there."""
    sim = sim_in("capsule", colon=COLON, wall=WallSolverCfg(self_contact=False), contact=contact)
    scope, still = sim.endoscope, torch.zeros(1, 3)
    scope.set_tip_velocity_command(torch.tensor([[0.0, 0.0, 0.05]]), still)
    sim.step(steps(sim, 5.0 / 6.0))
    scope.set_tip_velocity_command(still, still)
    upper = of_rings(sim, (13, 14, 15, 16, 17))
    wp.to_torch(sim.wall.nodes.anchors.rest)[upper, 0, 1] -= 0.045
    sim.step(steps(sim, 1.0))
    few = contact.search_reach == 3
    assert bool(sim.wall_penetrated[0]) == few
    beyond = sim.colon.data.nodal_pos_w[0, upper, 1].min() - scope.data.body_pos_w[0, -1, 1]
    assert (beyond < 0.0) == few


def test_what_it_needs_is_said(sim_in: HairpinSim) -> None:
    bends = LoopFrictionCfg(bends=True)
    with pytest.raises(ValueError, match=r"bends is true, which needs sim\.wall\.self_contact=true"):
        sim_in("capsule", loops=bends, wall=WallSolverCfg(self_contact=False))
    with pytest.raises(ValueError, match=r"pass through each other: set env\.sim\.loops\.bends=false"):
        sim_in("capsule", solver="newton", loops=bends)
