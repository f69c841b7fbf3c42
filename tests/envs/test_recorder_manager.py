# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Recording of the counter's episodes: two worlds, positions grow by twice the action, five steps each."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import torch

from arcgym.envs import ManagerBasedRLEnv, mdp
from arcgym.envs.provenance import settings_hash
from arcgym.managers import (
    Episode,
    MetricsTermCfg,
    RecorderManagerBaseCfg,
    RecorderTerm,
    RecorderTermCfg,
    RecordingError,
    TerminationTermCfg,
    episode_paths,
    export_hdf5,
    load_episodes,
    save_episode,
)
from arcgym.managers.recorder_files import claim_path, next_path
from arcgym.managers.recorder_joining import join
from arcgym.utils import configclass
from arcgym.utils.errors import TermError, UsageError


class PositionRecorder(RecorderTerm):
    """The position after each step, and where the episode started and ended."""

    def record_post_step(self):
        return "state", {"position": self._env.scene["counter"].position}

    def record_pre_reset(self, env_ids):
        return "end", self._env.scene["counter"].position[env_ids]

    def record_post_reset(self, env_ids):
        return "start", self._env.scene["counter"].position[env_ids]


@configclass
class RecorderCfg(RecorderManagerBaseCfg):
    position = RecorderTermCfg(class_type=PositionRecorder)
    actions = RecorderTermCfg(class_type=mdp.PreStepActionsRecorder)
    rewards = RecorderTermCfg(class_type=mdp.PostStepRewardsRecorder)
    observations: Any = None


def beyond(env, limit: float) -> torch.Tensor:
    return env.scene["counter"].position > limit


@pytest.fixture
def recording(cfg, tmp_path: Path):
    """Builds environments that record to a folder; world 1 succeeds above 5."""

    def build(**changes: Any) -> ManagerBasedRLEnv:
        recorders = RecorderCfg(dataset_export_dir_path=str(tmp_path))
        for name, value in changes.items():
            setattr(recorders, name, value)
        cfg.recorders = recorders
        cfg.terminations["beyond"] = TerminationTermCfg(func=beyond, params={"limit": 5.0}, success=True)
        cfg.metrics = {"top": MetricsTermCfg(func=lambda env: env.scene["counter"].position, reduce="max")}
        env = ManagerBasedRLEnv(cfg)
        env.reset()
        return env

    return build


def run(env: ManagerBasedRLEnv, steps: int, actions: tuple[float, float] = (0.5, 1.0)) -> None:
    for _ in range(steps):
        env.step(torch.tensor(actions).view(2, 1))


def test_an_episode_is_written_when_it_ends(recording, tmp_path) -> None:
    env = recording()
    run(env, 2)
    assert episode_paths(tmp_path) == []
    run(env, 1)
    # World 1 moves by 2 a step and passes 5 in its third.
    (episode,) = load_episodes(tmp_path)
    np.testing.assert_allclose(episode.data["state/position"], [2.0, 4.0, 6.0])
    np.testing.assert_allclose(episode.data["actions"], [[1.0]] * 3)
    np.testing.assert_allclose(episode.data["rewards/total"], [0.4, 0.8, 1.2], rtol=1e-5)
    assert (float(episode.data["start"]), float(episode.data["end"])) == (0.0, 6.0)


def test_info_says_how_it_ended(recording, tmp_path) -> None:
    run(recording(), 5)
    first, second = (episode.info for episode in load_episodes(tmp_path))
    assert (first["env_id"], first["length"], first["success"], first["ended_by"]) == (1, 3, True, ["beyond"])
    assert (second["env_id"], second["length"], second["time_out"], second["terminated"]) == (0, 5, True, False)
    assert second["complete"] and not second["success"]
    assert first["metrics"] == {"top": 6.0} and first["step_dt"] == pytest.approx(0.1)


def test_worlds_keep_their_episodes_apart(recording, tmp_path) -> None:
    run(recording(), 10)
    by_world = {0: [], 1: []}
    for episode in load_episodes(tmp_path):
        by_world[episode.info["env_id"]].append(episode.data["state/position"].tolist())
    assert by_world == {0: [[1.0, 2.0, 3.0, 4.0, 5.0]] * 2, 1: [[2.0, 4.0, 6.0]] * 3}


def test_close_and_reset_write_unfinished_episodes(recording, tmp_path) -> None:
    env = recording()
    run(env, 2)
    env.reset()
    run(env, 1)
    env.close()
    infos = [episode.info for episode in load_episodes(tmp_path)]
    assert [(info["length"], info["complete"]) for info in infos] == [(2, False)] * 2 + [(1, False)] * 2


def test_a_step_that_fails_is_not_recorded_and_the_ones_before_are(recording, tmp_path, monkeypatch) -> None:
    env = recording()
    run(env, 2)
    monkeypatch.setattr(env.sim, "step", lambda n: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run(env, 1)
    env.close()
    assert [len(episode.data["actions"]) for episode in load_episodes(tmp_path)] == [2, 2]


def test_only_successes(recording, tmp_path) -> None:
    env = recording(dataset_export_mode="succeeded_only")
    run(env, 7)
    env.close()
    assert [episode.info["env_id"] for episode in load_episodes(tmp_path)] == [1, 1]


def test_chosen_worlds(recording, tmp_path) -> None:
    run(recording(env_ids=(0,)), 5)
    (episode,) = load_episodes(tmp_path)
    assert episode.info["env_id"] == 0
    np.testing.assert_allclose(episode.data["state/position"], [1.0, 2.0, 3.0, 4.0, 5.0])


def test_observations_are_those_the_action_was_chosen_from(recording, tmp_path) -> None:
    run(recording(observations=mdp.PreStepObservationsRecorderCfg(groups=("critic",))), 3)
    (episode,) = load_episodes(tmp_path)
    np.testing.assert_allclose(episode.data["obs/critic"][:, 0], [0.0, 2.0, 4.0])


def test_files_are_never_overwritten(recording, tmp_path) -> None:
    for _ in range(2):
        env = recording()
        run(env, 3)
        env.close()
    assert [path.name for path in episode_paths(tmp_path)] == [f"episode_{k:06d}.hdf5" for k in range(4)]
    assert not list(tmp_path.glob("*.partial*"))


def test_nothing_is_asked_or_written_without_recorders(env, cfg, monkeypatch) -> None:
    assert not env.recorder_manager.active
    monkeypatch.setattr(type(env.recorder_manager), "_record_step", lambda *args: pytest.fail("asked"))
    run(env, 6)
    env.close()


def test_terms_that_answer_in_some_steps_only_are_told(recording) -> None:
    class Sometimes(RecorderTerm):
        def record_post_step(self):
            return ("now", self._env.reward_buf) if self._env.common_step_counter != 2 else (None, None)

    env = recording(observations=RecorderTermCfg(class_type=Sometimes))
    with pytest.raises(ValueError, match=r"\['now'\] come in some steps only"):
        run(env, 3)


def test_configuration_mistakes_are_named(cfg) -> None:
    cfg.recorders = {"actions": RecorderTermCfg(class_type=mdp.PreStepActionsRecorder)}
    with pytest.raises(TermError, match="type dict, expected a RecorderManagerBaseCfg"):
        ManagerBasedRLEnv(cfg)
    cfg.recorders = RecorderCfg(env_ids=(0, 2))
    with pytest.raises(IndexError, match="from 0 to 1"):
        ManagerBasedRLEnv(cfg)
    cfg.recorders = RecorderCfg(dataset_export_mode="some")
    with pytest.raises(UsageError, match="dataset_export_mode. expects.*Available: all, none, succeeded_only"):
        ManagerBasedRLEnv(cfg)


def test_joining_that_fails_leaves_nothing_behind(recording, tmp_path) -> None:
    run(recording(), 5)
    (tmp_path / "torn_000009.hdf5").write_bytes(b"no recording")
    with pytest.raises(RecordingError):
        join(sorted(tmp_path.glob("*.hdf5")), tmp_path / "out" / "all.hdf5")
    assert list((tmp_path / "out").iterdir()) == []


def test_episodes_can_be_joined_in_one_file(recording, tmp_path) -> None:
    run(recording(), 5)
    assert export_hdf5(tmp_path, tmp_path / "all.hdf5") == 2
    with h5py.File(tmp_path / "all.hdf5") as file:
        demo = file["data/demo_0"]
        np.testing.assert_allclose(demo["state/position"], [2.0, 4.0, 6.0])
        assert demo.attrs["num_samples"] == 3 and demo.attrs["success"]
        assert file["data"].attrs["total"] == 8
        assert json.loads(file["data"].attrs["env_args"])["type"] == "arcgym"
    lengths = [len(episode.data["actions"]) for episode in load_episodes(tmp_path / "all.hdf5")]
    assert lengths == [3, 5]


def test_provenance_and_settings_are_told(recording, tmp_path) -> None:
    env = recording()
    run(env, 5)
    episode = next(load_episodes(tmp_path))
    assert episode.provenance["seed"] == 0 and episode.provenance["device"] == "cpu"
    assert {"arcgym", "newton", "warp-lang", "torch"} <= set(episode.provenance["versions"])
    if (Path(__file__).parents[2] / ".git").exists():
        assert len(episode.provenance["versions"]["arcgym commit"].split()[0]) == 12
    assert episode.settings["decimation"] == 2 and episode.settings["scene"]["num_envs"] == 2
    assert episode.provenance["settings"] == settings_hash(episode.settings)
    assert settings_hash({**episode.settings, "decimation": 3}) != episode.provenance["settings"]
    assert settings_hash({**episode.settings, "log_dir": "elsewhere"}) == episode.provenance["settings"]


def long_episode(cfg) -> None:
    cfg.episode_length_s, cfg.terminations["above"] = 100.0, None


def test_a_second_that_is_over_is_on_disk(recording, cfg, tmp_path) -> None:
    long_episode(cfg)
    env = recording(env_ids=(0,), position=None)
    run(env, 9, (0.0, 0.0))
    assert not list(tmp_path.iterdir())
    run(env, 1, (0.0, 0.0))
    (partial,) = tmp_path.iterdir()
    assert partial.name == "episode_000000.partial.hdf5" and episode_paths(tmp_path) == []
    run(env, 15, (0.0, 0.0))
    assert len(Episode.load(partial).data["actions"]) == 20
    env.close()
    assert [episode.info["length"] for episode in load_episodes(tmp_path)] == [25]


KILLED = """
import os, signal, sys
sys.path.insert(0, {tests!r}); sys.path.insert(0, {envs!r})
import torch
import conftest, test_recorder_manager as own
cfg = conftest.CounterEnvCfg()
own.long_episode(cfg)
cfg.recorders = own.RecorderCfg(dataset_export_dir_path={folder!r})
env = own.ManagerBasedRLEnv(cfg)
env.reset()
own.run(env, 37, (0.01, 0.02))
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_kill_loses_at_most_the_last_second(tmp_path) -> None:
    here = Path(__file__).parent
    code = KILLED.format(tests=str(here.parent), envs=str(here), folder=str(tmp_path))
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=120)
    assert result.returncode == -signal.SIGKILL, result.stderr.decode()
    for world, path in enumerate(sorted(tmp_path.glob("*.partial.hdf5"))):
        episode = Episode.load(path)
        assert episode.info["recovered"] and not episode.info["complete"]
        assert episode.info["length"] == 30 and float(episode.data["start"]) == 0.0
        step = 0.02 * (world + 1)
        np.testing.assert_allclose(episode.data["state/position"], step * np.arange(1, 31), rtol=1e-5)
    assert world == 1
    assert next_path(tmp_path, "episode").name == "episode_000002.hdf5"


def test_a_full_disk_leaves_what_was_written(recording, cfg, tmp_path, monkeypatch) -> None:
    long_episode(cfg)
    env = recording(env_ids=(0,))
    run(env, 25, (0.01, 0.0))  # 20 steps are in the file

    def full(self, size, axis=None):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as disk:
        disk.setattr(h5py.Dataset, "resize", full)
        with pytest.raises(OSError, match="No space left"):
            run(env, 5, (0.01, 0.0))
        env.close()
    (partial,) = tmp_path.iterdir()
    episode = Episode.load(partial)
    assert episode.info["recovered"] and len(episode.data["actions"]) == 20


@pytest.mark.parametrize("kept", [4, 10, 13, 22])
def test_the_end_of_an_episode_can_be_taken_back(recording, cfg, tmp_path, kept) -> None:
    long_episode(cfg)
    env = recording(env_ids=(0,))
    run(env, 25, (0.01, 0.0))
    env.recorder_manager.shorten(0, kept)
    assert env.recorder_manager.length(0) == kept
    run(env, 12, (0.02, 0.0))
    env.close()
    (episode,) = load_episodes(tmp_path)
    np.testing.assert_allclose(episode.data["actions"][:, 0], [0.01] * kept + [0.02] * 12, rtol=1e-5)


def test_worlds_can_be_ignored_for_a_while(recording, cfg, tmp_path) -> None:
    long_episode(cfg)
    env = recording()
    run(env, 12, (0.01, 0.02))
    env.recorder_manager.ignore([1])
    assert [path.name for path in tmp_path.iterdir()] == ["episode_000000.partial.hdf5"]
    run(env, 12, (0.01, 0.02))
    env.recorder_manager.ignore([])
    env.reset()
    run(env, 3, (0.01, 0.02))
    env.close()
    found = [(episode.info["env_id"], episode.info["length"]) for episode in load_episodes(tmp_path)]
    assert found == [(0, 24), (0, 3), (1, 3)]


def test_files_that_are_no_recordings_are_named(tmp_path) -> None:
    with pytest.raises(RecordingError, match="There is no recording"):
        Episode.load(tmp_path / "none.hdf5")
    (tmp_path / "text.hdf5").write_text("no")
    with pytest.raises(RecordingError, match="no HDF5 file"):
        Episode.load(tmp_path / "text.hdf5")
    with h5py.File(tmp_path / "other.hdf5", "w") as file:
        file.create_group("data")
    with pytest.raises(RecordingError, match="no recording of ARCGym; expected version 1 or lower"):
        Episode.load(tmp_path / "other.hdf5")
    save_episode(Episode({"actions": np.zeros((2, 1))}, {"length": 2}), tmp_path / "one.hdf5")
    with pytest.raises(RecordingError, match="no 'data/demo_3'; it holds 1 episodes"):
        Episode.load(tmp_path / "one.hdf5", 3)


def test_processes_that_record_to_one_folder_take_names_of_their_own(tmp_path) -> None:
    """Two processes look for the next name before either of them has written anything."""
    found = threading.Barrier(2)

    def claim() -> Path:
        found.wait()
        return claim_path(tmp_path, "dataset")

    with ThreadPoolExecutor(2) as pool:
        for first in range(0, 40, 2):
            names = sorted(future.result().name for future in [pool.submit(claim) for _ in range(2)])
            assert names == [f"dataset_{first:06d}.hdf5", f"dataset_{first + 1:06d}.hdf5"]


def test_a_world_that_is_named_twice_is_recorded_once(recording, tmp_path) -> None:
    env = recording(env_ids=[1, 1])
    run(env, 3)
    assert [episode.info["env_id"] for episode in load_episodes(tmp_path)] == [1]
    assert env.recorder_manager.length(1) == 0


def test_a_world_that_breaks_at_its_goal_has_not_succeeded(recording, tmp_path) -> None:
    """The position is infinite: above 5, and no state of a world."""
    run(recording(), 1, actions=(0.5, float("inf")))
    (info,) = (episode.info for episode in load_episodes(tmp_path))
    assert info["terminated"] and not info["success"]
