# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""States stored to a file and written back into worlds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from tiny_sim import TinySim

from arcgym.sim import Simulation, Snapshot, SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.sim.snapshot_library import with_room


def moved(sim: Simulation, steps: int) -> Simulation:
    sim.endoscope.set_insertion_command(torch.full((sim.num_envs,), 0.1), torch.zeros(sim.num_envs))
    sim.step(steps)
    return sim


@pytest.fixture(scope="module")
def stored(tiny_sim: TinySim) -> SnapshotSet:
    """Two states: after 48 and after 96 steps of insertion at 0.1 m/s."""
    sim = tiny_sim()
    states = tuple(moved(sim, 48).read_snapshot(0) for _ in range(2))
    return SnapshotSet(("near", "far"), states, fingerprint(sim))


def memory(start: list[int], face: list[int], slide: list[float]) -> Snapshot:
    return Snapshot(
        {"contact_start": np.array(start), "contact_face": np.array(face), "contact_slide": np.array(slide)}
    )


def test_memory_of_contacts_fits_into_other_room() -> None:
    # One link, two contacts with faces 7 and 9; a simulation with room for three, then with room for one.
    state = memory([0, 2], [7, 9], [1.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    more = with_room(state, memory([0, 0], [0, 0, 0], [0.0] * 9)).arrays
    assert more["contact_face"].tolist() == [7, 9, 0]
    assert more["contact_slide"].tolist() == [1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    less = with_room(state, memory([0, 0], [0], [0.0] * 3)).arrays
    assert less["contact_start"].tolist() == [0, 0] and less["contact_face"].tolist() == [0]


def test_a_file_gives_back_what_was_saved(stored: SnapshotSet, tmp_path: Path) -> None:
    stored.save(tmp_path / "new" / "scope.npz")
    loaded = SnapshotSet.load(tmp_path / "new" / "scope.npz")
    assert (loaded.names, loaded.fingerprint) == (stored.names, stored.fingerprint)
    for read, written in zip(loaded.snapshots, stored.snapshots, strict=True):
        assert read.arrays.keys() == written.arrays.keys()
        for name, array in written.arrays.items():
            np.testing.assert_array_equal(read.arrays[name], array)
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["scope.npz"]


def test_worlds_take_the_states_they_are_given(stored: SnapshotSet, tiny_sim: TinySim) -> None:
    sim = tiny_sim(num_envs=3)
    rest = sim.endoscope.data.inserted_length[0].item()
    sim.load_snapshots(stored)
    sim.write_snapshot(torch.tensor([1, 0]), [0, 2])
    sim.forward()
    near, far = (rest + s.arrays["joint_q"][0] for s in stored.snapshots)
    assert sim.endoscope.data.inserted_length.tolist() == pytest.approx([far, rest, near], abs=1e-6)


def test_a_stored_state_goes_on_as_the_original(stored: SnapshotSet, tiny_sim: TinySim) -> None:
    sim, original = tiny_sim(), tiny_sim()
    sim.load_snapshots(stored)
    sim.write_snapshot(0)
    sim.forward()
    moved(sim, 48)
    moved(original, 96)
    torch.testing.assert_close(sim.endoscope.data.joint_pos, original.endoscope.data.joint_pos, atol=1e-6, rtol=0.0)
    torch.testing.assert_close(sim.colon.data.nodal_pos_w, original.colon.data.nodal_pos_w, atol=1e-6, rtol=0.0)


def test_a_stored_state_keeps_its_bending(tiny_sim: TinySim) -> None:
    sim = tiny_sim()
    sim.endoscope.set_bending_command(torch.tensor([0.1]), torch.tensor([-0.05]))
    sim.step(96)
    sim.load_snapshots(SnapshotSet(("bent",), (sim.read_snapshot(0),), fingerprint(sim)))
    sim.write_snapshot(-1)
    sim.write_snapshot(0)
    sim.forward()
    sim.step(48)
    torch.testing.assert_close(sim.endoscope.data.bending, torch.tensor([[0.1, -0.05]]))


def test_states_of_another_scope_are_refused(stored: SnapshotSet, tiny_sim: TinySim) -> None:
    with pytest.raises(
        ValueError, match="do not fit .*colon.usda with .*another wall mesh or endoscope .*arcgym snapshots"
    ):
        tiny_sim(links=8).load_snapshots(stored)


def test_states_of_another_wall_are_refused(stored: SnapshotSet, tiny_sim: TinySim) -> None:
    other = replace(stored, fingerprint="0" * 16)
    with pytest.raises(ValueError, match="fingerprint 0000000000000000"):
        tiny_sim().load_snapshots(other)


def test_states_of_other_actuators_are_refused(stored: SnapshotSet, tiny_sim: TinySim) -> None:
    with pytest.raises(ValueError, match="other actuators .differing in bending.angle"):
        tiny_sim(scope={"drives": {}, "actuators": {}}).load_snapshots(stored)


def test_what_a_file_says_about_its_states_is_kept(stored: SnapshotSet, tmp_path: Path) -> None:
    replace(stored, about={"arc": 0.5, "key": {"robot": "ab"}}).save(tmp_path / "scope.npz")
    assert SnapshotSet.load(tmp_path / "scope.npz").about == {"arc": 0.5, "key": {"robot": "ab"}}


def test_index_finds_a_state_by_name(stored: SnapshotSet) -> None:
    assert stored.index("far") == 1
    with pytest.raises(KeyError, match="no snapshot 'middle'.*'near', 'far'"):
        stored.index("middle")


@pytest.mark.parametrize("index", [-2, 2])
def test_a_state_that_is_not_there_is_refused(stored: SnapshotSet, tiny_sim: TinySim, index: int) -> None:
    sim = tiny_sim()
    sim.load_snapshots(stored)
    with pytest.raises(IndexError, match=f"index {index}: 2 snapshots are loaded"):
        sim.write_snapshot(index)


def test_a_missing_file_names_the_command_that_makes_it(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="arcgym snapshots"):
        SnapshotSet.load(tmp_path / "none.npz")


def test_at_rest_stops_everything_where_it_is() -> None:
    arrays = {"joint_q": np.ones(2), "joint_qd": np.ones(2), "nodal_vel": np.ones((3, 3))}
    still = Snapshot(arrays).at_rest().arrays
    assert still["joint_q"].all() and not still["joint_qd"].any() and not still["nodal_vel"].any()
