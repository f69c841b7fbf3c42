# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Friction between two tubes of 20 mm radius that lie 35 mm apart, and between the limbs of a hairpin."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from hairpin import COLON, LOWER, UPPER, HairpinSim, draw_together, of_rings, step_wall, two_tubes
from tiny_sim import own_patients

from arcgym.sim import LoopFrictionCfg, Simulation, WallSolverCfg
from arcgym.sim.contact.loop_friction import LoopFriction
from arcgym.sim.contact.self_contact import SelfContact
from arcgym.sim.wall.surroundings import Surroundings
from arcgym.utils.configclass import validate

STEP = 1.0 / 480.0


class Tubes:
    """Two tubes that touch, the second of which slides along the first in steps."""

    def __init__(self, friction: float = 0.05, stiffness: float = 100.0, device: str = "cpu") -> None:
        (self.points, self.ring), members = two_tubes(0.035, 0.02), np.arange(192).reshape(16, 12)
        rest, patient = two_tubes(0.045, 0.02)[0], own_patients(1, device)
        self.contact = SelfContact(WallSolverCfg(), [rest], self.ring, members, 0.002, patient, device)
        self.rub = LoopFriction(LoopFrictionCfg(friction=friction, stiffness=stiffness), 16, 1, device)
        groups = wp.array(members, dtype=int, device=device)
        self.around = Surroundings(self.ring, groups, 1, device, friction=self.rub)
        self.x = wp.array(self.points[:, None], dtype=wp.vec3, device=device)

    def slide(self, way: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what drags the tubes after the second has slid by ``way`` along Z, (2, 3), and pushes of rings [N]."""
        velocity = np.where(self.ring[:, None] >= 8, [0.0, 0.0, way / STEP], 0.0)
        v = wp.array(velocity[:, None], dtype=wp.vec3, device=self.x.device)
        measured, outer = self.contact.measure(self.x), self.around.force
        outer.push.zero_(), outer.stiffness.zero_()
        self.rub.measure(self.x, v, self.contact, STEP, outer)
        stiffness, plane = measured.stiffness.numpy()[:, 0], measured.plane.numpy()[:, 0]
        push = np.where(stiffness > 0.0, plane[:, 3] - stiffness * (plane[:, :3] * self.points).sum(axis=1), 0.0)
        # Where both go on at their mean velocity, as the step takes it.
        at = (self.points + [0.0, 0.0, 0.5 * way]).astype(np.float32)
        force = outer.push.numpy()[:, 0] - np.einsum("vij,vj->vi", outer.stiffness.numpy()[:, 0], at)
        drag = np.stack([force[self.ring < 8].sum(axis=0), force[self.ring >= 8].sum(axis=0)])
        return drag, np.bincount(self.ring, push)


def test_tubes_hold_each_other_until_they_slide() -> None:
    tubes = Tubes()
    pairs = 6  # rings side by side, 20 mm apart along the tubes, but for the two where the tube would turn
    for way, held in ((1.0e-4, 1.0e-4), (2.0e-4, 3.0e-4), (-1.0e-4, 2.0e-4)):
        drag, push = tubes.slide(way)
        assert (push[:6] > 1.0).all()
        np.testing.assert_allclose(drag[0], [0.0, 0.0, pairs * 100.0 * held], rtol=0.01, atol=1.0e-4)
        np.testing.assert_allclose(drag[1], -drag[0], atol=2.0e-4)  # action is reaction


@pytest.mark.parametrize("way", [0.01, -0.02])
def test_tubes_that_slide_are_dragged_by_coulombs_law(way: float) -> None:
    tubes = Tubes()
    for _ in range(3):
        drag, push = tubes.slide(way)
        np.testing.assert_allclose(drag[0, 2], np.sign(way) * 0.05 * push[:8].sum(), rtol=0.02)
        np.testing.assert_allclose(drag[1], -drag[0], atol=1.0e-4)
    back = tubes.slide(-np.sign(way) * 1.0e-4)[0]
    assert abs(drag[0, 2]) - abs(back[0, 2]) == pytest.approx(6 * 100.0 * 1.0e-4, rel=0.02)  # springs let go again


def test_without_friction_nothing_drags() -> None:
    assert not Tubes(friction=0.0).slide(0.01)[0].any()


def test_rings_that_part_forget() -> None:
    tubes = Tubes()
    tubes.slide(0.01)
    assert tubes.rub.ties.partner.numpy()[:6].any(axis=1).all()
    tubes.x.assign(two_tubes(0.045, 0.02)[0][:, None].astype(np.float32))
    tubes.slide(0.0)
    assert not tubes.rub.ties.partner.numpy().any()


@pytest.mark.parametrize(
    "device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA"))]
)
def test_groups_of_threads_do_as_one_does(device: str) -> None:
    plain, shared = Tubes(), Tubes(device=device)
    if device == "cpu":
        shared.contact.lanes = 1
    for way in (1.0e-4, 3.0e-3, -1.0e-4, -4.0e-3):
        for one, other in zip(plain.slide(way), shared.slide(way), strict=True):
            assert np.abs(one).max() > 1.0e-4
            np.testing.assert_allclose(other, one, rtol=0.0, atol=2.0e-5 * np.abs(one).max())
    np.testing.assert_array_equal(shared.rub.ties.partner.numpy(), plain.rub.ties.partner.numpy())


@pytest.fixture(scope="module")
def sim_in(tmp_path_factory: pytest.TempPathFactory) -> HairpinSim:
    return HairpinSim(tmp_path_factory.mktemp("rubbing"))


def rubbing(sim_in: HairpinSim, num_envs: int = 1) -> Simulation:
    return sim_in("capsule", num_envs=num_envs, colon=COLON, loops=LoopFrictionCfg(enabled=True))


def test_loops_that_slide_are_slowed(sim_in: HairpinSim) -> None:
    sim = rubbing(sim_in, num_envs=2)
    sim.write_loop_friction(torch.tensor([0.0, 0.5]))
    draw_together(sim, 0.025)
    step_wall(sim, 240)
    rest = wp.to_torch(sim.wall.nodes.anchors.rest)[:, 0]
    rest[of_rings(sim, LOWER), 2] += 0.005
    step_wall(sim, 24)
    moved = sim.colon.data.nodal_pos_w[:, of_rings(sim, LOWER), 2].mean(dim=1)
    other = sim.colon.data.nodal_pos_w[:, of_rings(sim, UPPER), 2].mean(dim=1)
    assert moved[1] < moved[0] - 1.0e-4 and other[1] > other[0] + 1.0e-4  # held back, and taken along
    step_wall(sim, 480)
    assert torch.isfinite(sim.colon.data.nodal_pos_w).all() and sim.colon.data.nodal_vel_w.abs().max() < 0.01


def test_loops_that_do_not_touch_are_as_without_it(sim_in: HairpinSim) -> None:
    with_it, without = rubbing(sim_in), sim_in("capsule", colon=COLON)
    for sim in (with_it, without):
        draw_together(sim, 0.003)
        step_wall(sim, 48)
    torch.testing.assert_close(with_it.colon.data.nodal_pos_w, without.colon.data.nodal_pos_w, rtol=0.0, atol=1.0e-7)
    assert without.surroundings is None and "loop_friction" in with_it.world_settings()
    with pytest.raises(ValueError, match=r"set env\.sim\.loops\.enabled=true"):
        without.write_loop_friction(torch.ones(1))


def test_what_it_needs_is_said(sim_in: HairpinSim) -> None:
    with pytest.raises(ValueError, match=r"which needs sim\.wall\.self_contact=true"):
        sim_in("capsule", loops=LoopFrictionCfg(enabled=True), wall=WallSolverCfg(self_contact=False))
    with pytest.raises(ValueError, match=r"has loops that pass through each other: set env\.sim\.loops\.enabled=false"):
        sim_in("capsule", solver="newton", loops=LoopFrictionCfg(enabled=True))
    with pytest.raises(ValueError, match="friction is -1"):
        validate(LoopFrictionCfg(friction=-1.0))
