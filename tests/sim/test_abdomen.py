# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The abdomen around the tiny tube, 0.2 m along Z with a radius of 21 mm, and a hand on its front."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
import warp as wp
from tiny import TINY_SEGMENTS
from tiny_sim import TinySim, steps

from arcgym.assets import AbdomenCfg
from arcgym.sim import Simulation, WeightCfg
from arcgym.sim.wall.abdomen import fit, vertex_area

FREE = dict.fromkeys(TINY_SEGMENTS, 0.0)


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("abdomen"))


def inside(tube: TinySim, num_envs: int = 1, colon: dict[str, Any] | None = None, **abdomen: Any) -> Simulation:
    """Make worlds with an abdomen."""
    cfg = AbdomenCfg(enabled=True, **abdomen)
    return tube("magnetic", num_envs=num_envs, colon={"abdomen": cfg, **(colon or {})})


def make_ball(sim: Simulation, radius: float, center: tuple[float, float, float] = (0.0, 0.0, 0.1)) -> None:
    """Make the inside of the abdomen a ball."""
    shape = sim.surroundings.abdomen.shape
    shape.tight.assign(np.full((1, 3), radius, np.float32))
    shape.center.assign(np.array([center], np.float32))
    shape.gap.zero_()


def forces(sim: Simulation) -> np.ndarray:
    """Return the force of the surroundings on every vertex of the first world where it is [N], shape (V, 3)."""
    sim.surroundings.measure(sim.nodal_pos, sim.wall.tissue, sim.physics_dt)
    force, x = sim.surroundings.force, sim.nodal_pos.numpy()[:, 0]
    return force.push.numpy()[:, 0] - np.einsum("vij,vj->vi", force.stiffness.numpy()[:, 0], x)


def test_without_an_abdomen_nothing_of_it_is_there(tube: TinySim) -> None:
    sim = tube()
    assert sim.surroundings is None and not any("abdomen" in name for name in sim.world_settings())
    with pytest.raises(ValueError, match=r"set env\.scene\.colon\.abdomen\.enabled=true"):
        sim.colon.set_hand_pressure(torch.zeros(1))


def test_it_just_holds_all_points() -> None:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-2, 2) for z in (0, 6)], float)
    center, axes = fit(corners, 2.0, 0.5)
    # An ellipsoid through the corners of a box has sqrt(3) times its half edges.
    np.testing.assert_allclose(center, [0.0, 0.0, 3.0])
    np.testing.assert_allclose(axes, np.sqrt(3.0) * np.array([1.0, 2.0, 3.0]) + 0.5)


def test_a_vertex_has_a_third_of_its_triangles() -> None:
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
    area = vertex_area(square, np.array([[0, 1, 2], [0, 2, 3]]))
    np.testing.assert_allclose(area, np.array([4, 2, 4, 2]) / 3.0)


def test_the_imaged_colon_touches_nothing(tube: TinySim) -> None:
    sim = inside(tube, gap=0.0)
    sim.step(12)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-6
    assert sim.colon.data.abdomen_force.item() == 0.0


def test_a_ball_pushes_by_depth(tube: TinySim) -> None:
    sim = inside(tube, stiffness=1.0e5, squareness=2.0)
    make_ball(sim, 0.09)
    away = sim.nodal_pos.numpy()[:, 0] - [0.0, 0.0, 0.1]
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    area = vertex_area(sim.colon.wall.points, sim.colon.wall.triangles)[:, None]
    expected = -1.0e5 * area * np.maximum(distance - 0.09, 0.0) * away / distance
    assert (np.abs(expected).sum(axis=1) > 0.0).sum() == 16  # the last ring at either end
    np.testing.assert_allclose(forces(sim), expected, rtol=2.0e-4, atol=2.0e-6)


def test_a_dent_loads_the_hand_by_what_it_takes_to_deepen_it(tube: TinySim) -> None:
    sim = inside(tube, squareness=2.0, hand_place=(0.0, 0.0), hand_radius=0.2)
    make_ball(sim, 0.1, (0.0, -0.08, 0.1))  # its front is at 20 mm, the wall's outermost vertices at 21 mm
    abdomen, energies = sim.surroundings.abdomen, []
    shape = abdomen.shape
    for dent in (0.0049, 0.0051, 0.005):
        abdomen.hand.dent.fill_(dent)
        size = np.linalg.norm(forces(sim), axis=1)
        stiffness = shape.stiffness.numpy()[0] * shape.area.numpy()[:, 0]
        energies.append(0.5 * (size**2 / stiffness).sum())
    load = abdomen.load.numpy()[:, 0].sum(axis=0)
    assert load[0] == pytest.approx((energies[1] - energies[0]) / 0.0002, rel=0.002)
    assert load[2] == pytest.approx(size.sum(), rel=1.0e-4) and load[2] > load[0] > 1.0


def test_a_dent_ends_at_twice_the_radius_of_the_hand(tube: TinySim) -> None:
    sim = inside(tube, squareness=2.0, hand_place=(0.0, 0.0), hand_radius=0.02)
    make_ball(sim, 5.0, (0.0, -4.9785, 0.1))  # nearly a plane, half a millimeter in front of the wall
    sim.surroundings.abdomen.hand.dent.fill_(0.005)
    push = np.linalg.norm(forces(sim), axis=1)
    front = np.abs(sim.colon.wall.points - [0.0, 0.021, 0.0])[:, :2].max(axis=1) < 1.0e-4
    away = np.abs(sim.colon.wall.points[front, 2] - 0.1)  # 0, 12.5, 25, 37.5, 50 mm and so on
    depth = push[front] / (3.0e5 * sim.surroundings.abdomen.shape.area.numpy()[front, 0])
    # Full depth up to 20 mm, cos^2(pi / 8) of the dent at 25 mm, over the slope there, nothing from 40 mm on.
    tilt = np.hypot(1.0, 0.005 * np.pi / 0.04 * np.sin(np.pi / 4.0))
    assert depth[away < 0.02] == pytest.approx(0.0045, rel=0.01)
    assert depth[np.abs(away - 0.025) < 1.0e-3] == pytest.approx(
        (0.005 * 0.8536 - 0.0005 + 0.025**2 / 10.0) / tilt, rel=0.01
    )
    assert (depth[(away > 0.04) & (away < 0.06)] == 0.0).all()


def test_a_hand_on_an_empty_belly_presses_it_in_by_its_stiffness(tube: TinySim) -> None:
    sim = inside(tube, gap=0.2, hand_stiffness=2000.0, hand_time=0.1)
    sim.colon.set_hand_pressure(torch.tensor([40.0]))
    sim.step(steps(sim, 0.1))  # one time constant
    assert sim.colon.data.hand_dent.item() == pytest.approx(0.02 * (1.0 - np.exp(-1.0)), rel=0.02)
    sim.step(steps(sim, 1.0))
    assert sim.colon.data.hand_dent.item() == pytest.approx(0.02, rel=1.0e-3)
    sim.colon.set_hand_pressure(torch.tensor([-40.0]))
    sim.step(steps(sim, 1.0))
    assert sim.colon.data.hand_dent.item() == pytest.approx(0.0, abs=1.0e-5)


def test_it_stops_a_wall_that_falls(tube: TinySim) -> None:
    weight = WeightCfg(enabled=True, posture="prone", imaged="weightless")
    front = []
    for enabled in (False, True):
        colon = {"anchor_stiffness": FREE, "youngs_modulus": 100.0, "abdomen": AbdomenCfg(enabled=enabled, gap=0.002)}
        sim = tube("magnetic", colon=colon, weight=weight)
        inner = 0.0 if sim.surroundings is None else sim.surroundings.abdomen.shape.tight.numpy()[0, 1] + 0.002
        sim.step(steps(sim, 0.2))
        front.append(sim.colon.data.nodal_pos_w[0, :, 1].max().item() - inner)
    # From 21 mm, without an abdomen by gravity for 0.2 s; with one to its front, where 0.3 N/mm^2 a meter bear foam.
    assert front[0] > 0.08 and -0.001 < front[1] < 0.002


def test_worlds_have_abdomens_and_hands_of_their_own(tube: TinySim) -> None:
    sim = inside(tube, num_envs=3, hand_place=(0.0, 0.0))
    sim.colon.write_abdomen_to_sim(stiffness=torch.tensor([1.0e4]), env_ids=[1])
    sim.colon.set_hand_pressure(torch.tensor([40.0, 40.0]), torch.tensor([[0.0, 0.0], [0.0, 0.02]]), env_ids=[1, 2])
    sim.step(steps(sim, 0.2))
    dent, moved = sim.colon.data.hand_dent, sim.colon.data.nodal_displacement.max(dim=1).values
    assert dent[0] == 0.0 and moved[0] < 1.0e-6
    assert dent[1] > dent[2] > 0.01 and moved[2] > 1.0e-4
    assert sim.world_settings()["abdomen.stiffness"].tolist() == pytest.approx([3.0e5, 1.0e4, 3.0e5])


def test_a_world_goes_on_from_its_state(tube: TinySim) -> None:
    first, second = (inside(tube, hand_place=(0.0, 0.0)) for _ in range(2))
    force, place = torch.tensor([40.0]), torch.tensor([[0.005, 0.01]])
    first.colon.set_hand_pressure(force, place)
    first.step(24)
    second.write_state({name: array.clone() for name, array in first.world_arrays().items()})
    second.forward()
    second.colon.set_hand_pressure(force)
    for sim in (first, second):
        sim.step(6)
    assert first.colon.data.hand_dent.item() == second.colon.data.hand_dent.item() > 0.005
    assert torch.equal(first.colon.data.nodal_pos_w, second.colon.data.nodal_pos_w)
    first.write_snapshot(-1)
    assert first.colon.data.hand_dent.item() == 0.0
    assert wp.to_torch(first.surroundings.abdomen.hand.force).item() == 0.0


def test_what_it_needs_is_said(tube: TinySim) -> None:
    with pytest.raises(ValueError, match=r"has no abdomen around the colon: set env\.scene\.colon\.abdomen\.enabled"):
        tube(solver="newton", colon={"abdomen": AbdomenCfg(enabled=True)})
    from arcgym.utils.configclass import validate

    with pytest.raises(ValueError, match=r"expected 'shell' with abdomen\.enabled=true"):
        validate(tube.colon_cfg(wall_model="solid", abdomen=AbdomenCfg(enabled=True)))
