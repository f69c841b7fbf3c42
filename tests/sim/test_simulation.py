# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two worlds, each a proximal scope that bends its tip against the wall: replay, repetition, resets, broken worlds."""

from __future__ import annotations

import pytest
import torch
import warp as wp
from tiny_sim import TinySim, steps

from arcgym.sensors.camera_view import CameraView
from arcgym.sim import Simulation, SimulationCfg
from arcgym.utils.configclass import validate

SOFT = {"youngs_modulus": 5.0e5}


@pytest.fixture(scope="module")
def narrow(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    """Return a tube of 11 mm radius, in which a bent tip soon meets the wall."""
    return TinySim(tmp_path_factory.mktemp("narrow"), radius=0.011)


class SceneOf(dict):
    """What a camera asks of a scene."""

    def __init__(self, sim: Simulation) -> None:
        super().__init__(endoscope=sim.endoscope)
        self.sim, self.num_envs, self.device = sim, sim.num_envs, sim.device


def build(narrow: TinySim, num_envs: int = 2, **cfg: object) -> Simulation:
    return narrow(num_envs=num_envs, colon=SOFT, scope={"drives": {"bending": {"rate": 4.0}}}, **cfg)


def drive(sim: Simulation, calls: list[int]) -> None:
    """Push on and bend the tip against the wall, both worlds differently."""
    n = sim.num_envs
    sim.endoscope.set_insertion_command(torch.full((n,), 0.1), torch.full((n,), 0.2))
    sim.endoscope.set_bending_command(torch.linspace(0.8, 1.2, n), torch.linspace(0.3, 0.1, n))
    for count in calls:
        sim.step(count)


def state(sim: Simulation) -> dict[str, torch.Tensor]:
    """All that a world's future depends on, and what managers read."""
    data = sim.endoscope.data
    read = {
        "body_pos": data.body_pos_w,
        "body_quat": data.body_quat_w,
        "tip": data.tip_pos_w,
        "arc": data.tip_arc_length,
        "force": data.link_force_w,
        "centers": sim.colon.data.centerline_pos_w,
    }
    return {name: array.clone() for name, array in {**sim.world_arrays(), **read}.items()}


def differing(a: Simulation | dict, b: Simulation | dict, world: int | slice = slice(None)) -> list[str]:
    """Names of the arrays that are not the same bit for bit."""
    a, b = (s if isinstance(s, dict) else state(s) for s in (a, b))
    return [name for name in a if not torch.equal(a[name][world], b[name][world])]


def test_the_driven_scope_touches_the_wall(narrow: TinySim) -> None:
    sim = build(narrow)
    drive(sim, [144, 48])
    assert (sim.endoscope.data.link_force_w.norm(dim=-1).amax(dim=1) > 1.0).all()
    assert (sim.colon.data.nodal_displacement.amax(dim=1) > 1e-4).all()


def test_graph_replay_equals_eager_bit_for_bit(narrow: TinySim) -> None:
    graph, eager = build(narrow, use_graph=True), build(narrow, use_graph=False)
    for sim in (graph, eager):
        drive(sim, [144, 10])
    assert differing(graph, eager) == []


def test_same_inputs_give_the_same_result(narrow: TinySim) -> None:
    first, second = build(narrow), build(narrow)
    for sim in (first, second):
        drive(sim, [144])
    assert differing(first, second) == []


def test_a_camera_looks_between_the_steps_of_a_call_and_changes_none(narrow: TinySim) -> None:
    """It looks as many whole steps before the end of the call as are nearest to 7 ms."""
    seen, plain = build(narrow), build(narrow)
    view, ago = CameraView(SceneOf(seen), 0.007), steps(seen, 0.007)
    drive(seen, [8])
    drive(plain, [8 - ago])
    late = wp.to_torch(view.shot.pose).clone()
    assert torch.equal(late, wp.to_torch(plain.endoscope.camera_pose_wp))
    assert torch.equal(wp.to_torch(view.shot.wall), wp.to_torch(plain.nodal_pos))
    plain.step(ago)
    assert not differing(seen.world_arrays(), plain.world_arrays())


def test_one_call_of_two_steps_equals_two_calls(narrow: TinySim) -> None:
    together, apart = build(narrow), build(narrow)
    drive(together, [144, 2])
    drive(apart, [144, 1, 1])
    forces = {"force"}  # averaged over one call
    assert set(differing(together, apart)) <= forces


def test_a_world_does_not_depend_on_its_neighbors(narrow: TinySim) -> None:
    alone, pair = build(narrow, num_envs=1), build(narrow, num_envs=2)
    drive(alone, [144])
    pair.endoscope.set_insertion_command(torch.tensor([0.1, -0.1]), torch.tensor([0.2, 0.0]))
    pair.endoscope.set_bending_command(torch.tensor([0.8, -1.0]), torch.tensor([0.3, 0.0]))
    pair.step(144)
    assert differing(alone, pair, world=0) == []


def test_forces_are_averaged_over_the_call(narrow: TinySim) -> None:
    together, apart = build(narrow), build(narrow)
    drive(together, [144, 4])
    drive(apart, [144])
    means, bases = [], []
    for _ in range(4):
        apart.step(1)
        means.append(apart.endoscope.data.link_force_w.clone())
        bases.append(apart.endoscope.data.base_force.clone())
    means = torch.stack(means)
    torch.testing.assert_close(together.endoscope.data.link_force_w, means.mean(dim=0))
    torch.testing.assert_close(together.endoscope.data.link_force_peak, means.norm(dim=-1).amax(dim=0))
    torch.testing.assert_close(together.endoscope.data.base_force, torch.stack(bases).mean(dim=0))


def reset_world_1(sim: Simulation) -> None:
    sim.write_snapshot(-1, [1])
    sim.forward()


def test_reset_leaves_the_other_world_as_it_was(narrow: TinySim) -> None:
    sim = build(narrow)
    drive(sim, [144])
    before = state(sim)
    reset_world_1(sim)
    assert differing(before, sim, world=0) == []


def test_reset_makes_a_world_like_new(narrow: TinySim) -> None:
    sim, fresh = build(narrow), build(narrow)
    drive(sim, [144])
    reset_world_1(sim)
    assert differing(fresh, sim, world=1) == []


def test_after_a_reset_both_worlds_go_on_as_if_alone(narrow: TinySim) -> None:
    sim, undisturbed, fresh = (build(narrow) for _ in range(3))
    for one in (sim, undisturbed):
        drive(one, [144])
    reset_world_1(sim)
    for one in (sim, undisturbed, fresh):
        drive(one, [10])
    assert differing(undisturbed, sim, world=0) == []
    assert differing(fresh, sim, world=1) == []


def test_reset_clears_commands_and_forces(narrow: TinySim) -> None:
    sim = build(narrow)
    drive(sim, [144])
    sim.write_snapshot(-1, [1])
    data, base = sim.endoscope.data, sim.endoscope.actuator("base")
    for force in (data.link_force_w, data.link_force_norm, data.link_force_peak, data.base_force):
        assert force[0].any() and not force[1].any()
    sim.forward()
    torch.testing.assert_close(data.link_force_norm, data.link_force_w.norm(dim=-1))
    assert base.velocity.numpy()[1] == 0.0
    assert base.velocity.numpy()[0] == pytest.approx(0.1)


@pytest.mark.parametrize("broken", ["wall", "scope"])
def test_a_broken_world_is_flagged_and_harms_no_other(narrow: TinySim, broken: str) -> None:
    sim, undisturbed = build(narrow), build(narrow)
    for one in (sim, undisturbed):
        drive(one, [48])
    array = sim.colon.data.nodal_pos_w[1, 100] if broken == "wall" else sim.endoscope.data.joint_pos[1]
    array.fill_(float("nan"))
    for one in (sim, undisturbed):
        one.step(10)
    assert sim.non_finite.tolist() == [False, True]
    assert differing(undisturbed, sim, world=0) == []


@pytest.mark.parametrize("broken", ["wall", "scope"])
def test_a_broken_world_is_mended_by_a_reset(narrow: TinySim, broken: str) -> None:
    sim, fresh = build(narrow), build(narrow)
    drive(sim, [48])
    array = sim.colon.data.nodal_pos_w[1, 100] if broken == "wall" else sim.endoscope.data.joint_pos[1]
    array.fill_(float("nan"))
    sim.step(10)
    reset_world_1(sim)
    assert sim.non_finite.tolist() == [False, False]
    for one in (sim, fresh):
        drive(one, [10])
    assert differing(fresh, sim, world=1) == []


def test_a_world_that_left_the_room_is_flagged(narrow: TinySim) -> None:
    sim = build(narrow)
    sim.colon.data.nodal_pos_w[0, 100, 1] = 11.0
    sim.forward()
    assert sim.non_finite.tolist() == [True, False]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"solver": "jelly"}, "'solver' expects Literal.'two_level', 'newton'., got str 'jelly'"),
        ({"scope_substeps": 0}, "scope_substeps is 0, expected a number at least 1"),
        ({"dt": 0.1}, "dt is 0.1 s, expected a number above 0 and at most 0.0166667 s"),
        ({"mass_scaling": 0.0}, "mass_scaling is 0.0, expected a number above 0"),
    ],
)
def test_impossible_settings_are_refused(changes: dict, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        validate(SimulationCfg(**changes))


def test_no_worlds_are_refused(narrow: TinySim) -> None:
    with pytest.raises(ValueError, match="num_envs is 0, expected 1 or more worlds"):
        build(narrow, num_envs=0)
