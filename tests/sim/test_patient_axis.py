# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds with different patients in one batch: every world goes on as if its patient were the only one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from tiny import write_tiny_colon
from tiny_sim import TinySim, steps

from arcgym.assets import AbdomenCfg, MesenteryCfg
from arcgym.sim import Simulation, SnapshotSet
from arcgym.sim.snapshot import fingerprint

TUBES = {
    "straight": {},
    "bent": {"bend": 1.2, "length": 0.24, "radius": 0.018, "segments": ("rectum", "sigmoid", "descending")},
}
"""A straight tube and a bent, longer, narrower one of other segments, both of 17 rings of 8 vertices."""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("patients"))


@pytest.fixture(scope="module")
def paths(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("tubes")
    for name in TUBES:
        (folder / name).mkdir()
    return [str(write_tiny_colon(folder / name, **tube)) for name, tube in TUBES.items()]


def push(sim: Simulation) -> Simulation:
    """Push the capsule of every world into its wall for 1/24 s."""
    sim.endoscope.data.joint_pos[:] = torch.tensor([0.011, 0.0015, 0.05, 0.0, 0.0, 0.0, 1.0])
    sim.endoscope.data.joint_vel.zero_()
    sim.forward()
    aside = torch.tensor([[0.2, 0.0, 0.0]]).repeat(sim.num_envs, 1)
    sim.endoscope.set_tip_velocity_command(aside, torch.zeros_like(aside))
    sim.step(steps(sim, 1.0 / 24.0))
    return sim


def state(sim: Simulation, world: int) -> dict[str, np.ndarray]:
    return {name: array[world].numpy().copy() for name, array in sim.world_arrays().items()}


def assert_same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    for name, array in one.items():
        np.testing.assert_array_equal(array, other[name], err_msg=name)


@pytest.fixture(scope="module")
def alone(tiny: TinySim, paths: list[str]) -> list[Simulation]:
    """Each patient in a simulation of its own, pushed."""
    return [push(tiny("capsule", colon={"usd_path": path})) for path in paths]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_world_goes_on_as_with_its_patient_alone(
    tiny: TinySim, paths: list[str], alone: list[Simulation], order: tuple[int, int]
) -> None:
    sim = push(tiny("capsule", num_envs=3, colon={"usd_path": [paths[k] for k in order]}))
    assert sim.colon.data.patient.tolist() == [0, 1, 0]
    for world in range(3):
        one = alone[order[world % 2]]
        assert one.colon.data.nodal_displacement.max() > 1.0e-5
        assert_same(state(sim, world), state(one, 0))
        for name in ("tip_arc_length", "tip_centerline_distance", "tip_segment", "window_force_norm"):
            assert torch.equal(getattr(sim.endoscope.data, name)[world], getattr(one.endoscope.data, name)[0])
        for name in ("wall_strain", "anchor_tension", "centerline_arc", "segment_spans", "nodal_displacement"):
            assert torch.equal(getattr(sim.colon.data, name)[world], getattr(one.colon.data, name)[0])


def test_a_solid_wall_has_patients_too(tiny: TinySim, paths: list[str]) -> None:
    colon = {"wall_model": "solid", "youngs_modulus": 0.5e6}
    both = push(tiny("capsule", num_envs=2, colon={"usd_path": paths, **colon}))
    for world, path in enumerate(paths):
        one = push(tiny("capsule", colon={"usd_path": path, **colon}))
        assert_same(state(both, world), state(one, 0))


def test_abdomens_and_mesenteries_are_their_patients(tiny: TinySim, paths: list[str]) -> None:
    around = {
        "abdomen": AbdomenCfg(enabled=True, gap=0.0, hand_place=(0.0, 0.0), hand_time=0.02),
        "mesentery": MesenteryCfg(enabled=True),
    }

    def pressed(path: str | list[str], num_envs: int) -> Simulation:
        sim = tiny("capsule", num_envs=num_envs, colon={"usd_path": path, "material": "in_situ", **around})
        sim.colon.set_hand_pressure(torch.full((num_envs,), 40.0))
        return push(sim)

    both = pressed(paths, 2)
    for world, path in enumerate(paths):
        one = pressed(path, 1)
        assert one.colon.data.abdomen_force.item() > 0.01 and one.colon.data.hand_dent.item() > 0.001
        assert_same(state(both, world), state(one, 0))
    assert both.colon.data.abdomen_force[0] != both.colon.data.abdomen_force[1]


def test_a_world_that_takes_another_patient_goes_on_as_that_one(
    tiny: TinySim, paths: list[str], alone: list[Simulation]
) -> None:
    sim = push(tiny("capsule", num_envs=2, colon={"usd_path": paths}))
    before = state(sim, 1)
    sim.colon.write_patient_to_sim(torch.tensor([1]), torch.tensor([0]))
    sim.write_snapshot(-1, torch.tensor([0]))
    assert sim.colon.data.patient.tolist() == [1, 1]
    assert not sim.colon.data.nodal_displacement[0].any()
    assert_same(state(sim, 1), before)
    sim.write_snapshot(-1)
    push(sim)
    assert_same(state(sim, 0), state(alone[1], 0))
    assert_same(state(sim, 1), state(alone[1], 0))


def test_no_kernel_or_graph_is_made_anew(tiny: TinySim, paths: list[str]) -> None:
    sim = push(tiny("capsule", num_envs=2, colon={"usd_path": paths}))
    graph = sim._physics.recorded
    sim.colon.write_patient_to_sim(torch.tensor([1, 0]))
    sim.write_snapshot(-1)
    push(sim)
    assert graph is not None and sim._physics.recorded is graph


def test_each_patient_has_start_states_of_its_own(tiny: TinySim, paths: list[str]) -> None:
    sim = push(tiny("capsule", num_envs=2, colon={"usd_path": paths}))
    marks = [fingerprint(sim, patient) for patient in range(2)]
    states = [sim.read_snapshot(world) for world in range(2)]
    sets = [SnapshotSet(("a", "b"), (states[0], states[0]), marks[0]), SnapshotSet(("b",), (states[1],), marks[1])]
    sim.load_snapshots(sets)
    assert sim.snapshots is not None and sim.snapshots.names == ("b",)
    sim.colon.write_patient_to_sim(torch.tensor([1, 0]))
    sim.write_snapshot(0)
    for world, patient in ((0, 1), (1, 0)):
        np.testing.assert_array_equal(state(sim, world)["nodal_pos"], states[patient].arrays["nodal_pos"])
    with pytest.raises(ValueError, match="do not fit .*straight.colon.usda"):
        sim.load_snapshots(sets[::-1])
    with pytest.raises(ValueError, match="1 sets of start states .*each of 2 patients"):
        sim.load_snapshots(sets[0])


def test_a_patient_that_does_not_exist_is_refused(tiny: TinySim, paths: list[str]) -> None:
    sim = tiny("capsule", colon={"usd_path": paths})
    with pytest.raises(IndexError, match=r"patient is \[2\], expected indices from 0 to 1"):
        sim.colon.write_patient_to_sim(torch.tensor([2]))


@pytest.mark.parametrize(
    ("tube", "message"),
    [
        (
            {"rings": 18},
            "other.colon.usda has a wall of 18 rings and 144 vertices, .*straight.colon.usda one of 17 rings",
        ),
        ({"sectors": 10}, "17 rings and 170 vertices"),
        ({"thickness": 0.003}, "thickness of 0.003 m, .* set env.scene.colon.wall_thickness"),
    ],
)
def test_patients_that_cannot_share_a_batch_are_named(
    tiny: TinySim, paths: list[str], tmp_path: Path, tube: dict[str, float], message: str
) -> None:
    (tmp_path / "other").mkdir()
    other = write_tiny_colon(tmp_path / "other", **tube)
    with pytest.raises(ValueError, match=message):
        tiny("capsule", colon={"usd_path": [paths[0], str(other)]})


def test_plain_newton_is_refused(tiny: TinySim, paths: list[str]) -> None:
    with pytest.raises(ValueError, match="solver='newton' has one patient in all worlds: choose solver='two_level'"):
        tiny("capsule", colon={"usd_path": paths}, solver="newton")
