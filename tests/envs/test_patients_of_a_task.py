# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A task with several patients: they are drawn at resets, and episodes say in which one they were."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from tiny import write_tiny_colon

import arcgym_tasks  # noqa: F401
from arcgym.envs import mdp
from arcgym.managers import Episode, episode_paths
from arcgym.recordings.replay import replay
from arcgym.recordings.restoring import mismatches, restored_cfg
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Splenic-Capsule"
BENDS = {"first": 0.0, "second": 0.6, "third": 1.2}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of three patients, tubes that are bent ever more."""
    folder = tmp_path_factory.mktemp("patients")
    for name, bend in BENDS.items():
        (folder / name).mkdir()
        write_tiny_colon(folder / name, bend=bend)
    return folder


def cfg_of(usd_path: Any, num_envs: int = 4) -> Any:
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path = num_envs, usd_path
    cfg.scene.camera.width = cfg.scene.camera.height = 36
    cfg.start, cfg.seed, cfg.episode_length_s = "rest", 3, 0.5
    return cfg


@pytest.fixture(scope="module")
def recorded(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path, list[list[int]]]:
    """The environment after 12 steps of episodes of five, its recordings, and the patients in every step."""
    out = tmp_path_factory.mktemp("recorded")
    cfg = cfg_of(str(folder))
    cfg.recorders = mdp.TrajectoryRecorderCfg(dataset_export_dir_path=str(out))
    env = gym.make(TASK, cfg=cfg).unwrapped
    env.reset()
    patients = []
    for _ in range(12):
        patients.append(env.scene["colon"].data.patient.tolist())
        env.step(torch.tensor([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]).expand(4, 6))
    env.close()
    return env, out, patients


def test_patients_change_at_resets_alone(recorded: tuple[Any, Path, list[list[int]]]) -> None:
    env, _, patients = recorded
    assert [patient.name for patient in env.scene["colon"].patients] == list(BENDS)
    rows = np.array(patients)
    assert (rows[:5] == rows[0]).all() and (rows[5:10] == rows[5]).all()
    assert (rows[0] != rows[5]).any() or (rows[5] != rows[10]).any()
    assert set(rows.ravel()) <= {0, 1, 2}


def test_the_seed_decides_which_patients_come(folder: Path, recorded: tuple[Any, Path, list[list[int]]]) -> None:
    env = gym.make(TASK, cfg=cfg_of(str(folder))).unwrapped
    env.reset()
    assert env.scene["colon"].data.patient.tolist() == recorded[2][0]


def test_metrics_and_recordings_name_the_patient(recorded: tuple[Any, Path, list[list[int]]]) -> None:
    env, out, patients = recorded
    assert env.metrics_manager.finished["patient_index"].tolist() == patients[9]
    assert not any("patient" in name for name in env.extras["log"])
    names = list(BENDS)
    for path in episode_paths(out):
        episode = Episode.load(path)
        world = episode.info["env_id"]
        assert episode.info["patient"] in {names[row[world]] for row in patients}
        assert Path(episode.provenance["stages"]["colon"]["path"]).parent.name == episode.info["patient"]
        assert names[int(episode.data["world_settings/patient"])] == episode.info["patient"]


def test_a_recording_is_replayed_with_its_patient_alone(recorded: tuple[Any, Path, list[list[int]]]) -> None:
    episodes = [Episode.load(path) for path in episode_paths(recorded[1])]
    episode = next(one for one in episodes if one.info["patient"] != "first")
    task, cfg = restored_cfg(episode, None, "cpu")
    assert episode.info["patient"] in cfg.scene.colon.usd_path and mismatches(episode, cfg) == []
    result = replay(gym.make(task, cfg=cfg).unwrapped, episode)
    assert result.is_exact, str(result)


def test_pictures_are_of_the_worlds_own_patients(folder: Path) -> None:
    """Every world's image is the one that it has with its patient alone, but for rounding where triangles meet."""
    cfg = cfg_of(str(folder), num_envs=3)
    cfg.events.patient = None
    obs, _ = gym.make(TASK, cfg=cfg).unwrapped.reset(seed=1)
    for world, name in enumerate(BENDS):
        alone = cfg_of(str(folder / name), num_envs=3)
        own, _ = gym.make(TASK, cfg=alone).unwrapped.reset(seed=1)
        difference = (obs["policy"][world].int() - own["policy"][world].int()).abs()
        assert int((difference > 1).sum()) < 0.001 * difference.numel()


def test_a_segment_that_a_patient_lacks_is_named(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "short").mkdir()
    short = write_tiny_colon(tmp_path / "short", segments=("rectum", "sigmoid"))
    with pytest.raises(ValueError, match=r"Segment 'splenic' is not in .*short.colon.usda.*rectum, sigmoid"):
        gym.make(TASK, cfg=cfg_of([str(folder / "first" / "colon.usda"), str(short)]))
