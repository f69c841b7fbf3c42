# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The patients that a checkpoint was trained on, by what lies beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py
import pytest

from arcgym.evaluation.trained_on import trained_on
from arcgym.rl.run_folder import write_params

ON_COLON_1 = {"scene": {"colon": {"usd_path": "colon_1/colon.usda"}}}
TRAIN = "env.scene.colon.usd_path=[colon_1/colon.usda,population:train]"


@pytest.mark.parametrize(
    ("colon", "command", "patients"),
    [
        ({"usd_path": "ct_1/colon.usda"}, [TRAIN], "ct_1/colon.usda"),
        ({}, ["arcgym", "train", TRAIN, "env.scene.colon.num_patients=9"], ["colon_1/colon.usda", "population:train"]),
        ({}, ["env.scene.colon.usd_path=population:7*0.5"], "population:7*0.5"),
        ({}, ["arcgym", "train", "--task", "ARC-Rectum-Capsule"], None),
        ({}, None, None),
    ],
)
def test_parameters_name_them_or_the_command_does(tmp_path: Path, colon: dict, command: list | None, patients: Any):
    run = {"task": "ARC-Rectum-Capsule"} | ({} if command is None else {"command": command})
    write_params(tmp_path, run=run, env={"scene": {"colon": colon}}, agent={})
    assert trained_on(tmp_path / "model_0.pt") == patients


def test_nothing_beside_it_says_so(tmp_path: Path) -> None:
    assert trained_on(tmp_path / "model_0.pt") is None
    write_params(tmp_path, run={"task": "ARC-Rectum-Capsule"}, env={}, agent={})
    assert trained_on(tmp_path / "model_0.pt") is None


def test_those_that_a_run_began_from_are_its_patients_too(tmp_path: Path) -> None:
    """A second run in colon 1 that went on from one in colon 2, and a third that went on from a file that is gone."""
    run = {"task": "ARC-Rectum-Capsule"}
    first, second, third = tmp_path / "first", tmp_path / "second", tmp_path / "third"
    began = {second: str(first / "model_0.pt"), third: str(tmp_path / "gone.pt")}
    for folder, colon in ((first, "colon_2/colon.usda"), (second, "colon_1/colon.usda"), (third, "colon_1/colon.usda")):
        folder.mkdir()
        agent = {"init_policy": began[folder]} if folder in began else {}
        write_params(folder, run=run, env={"scene": {"colon": {"usd_path": colon}}}, agent=agent)
        (folder / "model_0.pt").touch()
    assert trained_on(second / "model_0.pt") == ["colon_1/colon.usda", "colon_2/colon.usda"]
    assert trained_on(third / "model_0.pt") == ["colon_1/colon.usda", f"unknown: {tmp_path / 'gone.pt'}"]


def test_those_of_recorded_episodes_are_its_patients_too(tmp_path: Path) -> None:
    """A clone of episodes in two patients of the population, one of them twice, and one of a folder that is gone."""
    recorded = tmp_path / "dataset"
    for number, patient in enumerate(("patient_020000", "patient_020000", "patient_000007")):
        _record(recorded / f"folder_{number}" / "episode_000000.hdf5", f"cache/{patient}/colon.usda")
    clone, lost = tmp_path / "clone", tmp_path / "lost"
    for folder, demonstrations in ((clone, recorded), (lost, tmp_path / "gone")):
        folder.mkdir()
        agent = {"algorithm": {"demonstrations": str(demonstrations)}}
        write_params(folder, run={"task": "ARC-Rectum-Capsule"}, env=ON_COLON_1, agent=agent)
    stages = ["cache/patient_020000/colon.usda", "cache/patient_000007/colon.usda"]
    assert trained_on(clone / "model_0.pt") == ["colon_1/colon.usda", *stages]
    assert trained_on(lost / "model_0.pt") == ["colon_1/colon.usda", f"unknown: {tmp_path / 'gone'}"]


def test_those_of_the_run_that_it_went_on_from_are_its_patients_too(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    for folder, colon in ((first, "ct_1/colon.usda"), (second, "colon_1/colon.usda")):
        folder.mkdir()
        (folder / "model_0.pt").touch()
        run = {"task": "ARC-Rectum-Capsule"} | ({"resumed_from": str(first / "model_0.pt")} if folder == second else {})
        write_params(folder, run=run, env={"scene": {"colon": {"usd_path": colon}}}, agent={})
    assert trained_on(second / "model_0.pt") == ["colon_1/colon.usda", "ct_1/colon.usda"]


def test_an_expert_is_asked_in_the_patients_of_the_run(tmp_path: Path) -> None:
    agent = {"algorithm": {"demonstrations": "expert"}}
    write_params(tmp_path, run={"task": "ARC-Rectum-Capsule"}, env=ON_COLON_1, agent=agent)
    assert trained_on(tmp_path / "model_0.pt") == "colon_1/colon.usda"


def _record(path: Path, stage: str) -> None:
    """Write what a recording says about its patient, and nothing else."""
    path.parent.mkdir(parents=True)
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs["arcgym_recording"] = 1
        demo = file.create_group("data/demo_0")
        demo.attrs["provenance"] = json.dumps({"stages": {"colon": {"path": stage}}})
