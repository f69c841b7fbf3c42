# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states left alone, and those that lie beside colons."""

from __future__ import annotations

import dataclasses
import shutil

import numpy as np
import pytest

from arcgym.sim import SnapshotSet
from arcgym.start_states import shipped
from arcgym.start_states.key import state_key
from arcgym.start_states.settling import ALONE, CONTROL_STEP, changes
from arcgym.utils.paths import assets_dir


@pytest.fixture(scope="module")
def capsules(tmp_path_factory: pytest.TempPathFactory) -> shipped.Shipped:
    """First state of the capsule in copies of colons 1 and 2."""
    paths, base = [], tmp_path_factory.mktemp("shipped")
    for name in ("colon_1", "colon_2"):
        folder = base / name
        shutil.copytree(assets_dir() / name, folder)
        file = folder / "snapshots" / "capsule.npz"
        SnapshotSet.load(file).only(["rectum", "sigmoid"]).save(file)
        paths.append(str(folder / "colon.usda"))
    return shipped.load("capsule", "paper", paths, "cpu")


def test_changes_are_shares_of_the_first_forces() -> None:
    forces = np.array([[[2.0, 0.0]], [[2.5, 0.01]], [[1.0, 0.0]]])
    np.testing.assert_allclose(changes(forces), [[[0.0, 0.0]], [[0.25, 0.1]], [[0.5, 0.0]]])


def test_every_state_beside_some_colons_is_left_alone(capsules: shipped.Shipped) -> None:
    assert capsules.keys == [(0, "rectum"), (0, "sigmoid"), (1, "rectum"), (1, "sigmoid")]
    forces = capsules.left_alone(capsules.keys)
    assert forces.shape == (round(ALONE / CONTROL_STEP), 4, 2)
    assert forces[:, [1, 3], 0].min() > 0.0 and changes(forces).max() < 0.05


def test_a_state_that_settles_again_takes_its_place_in_the_file(capsules: shipped.Shipped) -> None:
    room = len(capsules.scene.sim.read_snapshot(0).arrays["contact_face"])
    before = capsules.sets[1]
    assert all(len(state.arrays["contact_face"]) == room for state in before.snapshots)
    capsules.settle([(1, "sigmoid")])
    capsules.save(1)
    after = SnapshotSet.load(capsules.files[1])
    same = {name: np.array_equal(a, after.snapshots[0].arrays[name]) for name, a in before.snapshots[0].arrays.items()}
    moved = np.abs(after.snapshots[1].arrays["nodal_pos"] - before.snapshots[1].arrays["nodal_pos"]).max()
    assert all(same.values()) and 0.0 < moved < 1.0e-3
    key = state_key(capsules.scene.colon, capsules.scene.endoscope, capsules.scene.sim.cfg, 1)
    assert after.about == {**before.about, "key": dataclasses.asdict(key)}
