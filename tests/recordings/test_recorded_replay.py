# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An episode of one of two worlds, made again in a world of its own."""

from __future__ import annotations

import dataclasses

import gymnasium as gym
import imageio_ffmpeg
import numpy as np
import pytest
import torch

from arcgym.cli.main import main
from arcgym.envs import mdp
from arcgym.managers import Episode, episode_paths, save_episode
from arcgym.recordings.pieces import STATE, replay_pieces
from arcgym.recordings.replay import replay
from arcgym.recordings.restoring import mismatches, restored_cfg
from arcgym.utils.errors import UsageError


@pytest.fixture(scope="module")
def episode(recorded) -> Episode:
    """The second world's."""
    return Episode.load(episode_paths(recorded)[1])


@pytest.fixture(scope="module")
def again(episode):
    """The environment that the recording asks for."""
    task, cfg = restored_cfg(episode, None, "cpu")
    return gym.make(task, cfg=cfg).unwrapped


def test_recording_holds_what_the_schema_says(episode) -> None:
    assert {"metrics/progress", "forces/tip", "wall/positions", "rewards/total"} <= episode.steps
    assert episode.data["actions"].shape == (14, 6) and episode.data["obs/policy"].dtype == np.uint8
    assert episode.data["world_settings/friction"].shape == () and "final_state/nodal_pos" in episode.data
    assert episode.provenance["task"] == "ARC-Splenic-Capsule" and episode.provenance["env_id"] == 1
    assert set(episode.provenance["stages"]) == {"colon", "endoscope"}


def test_recording_does_not_say_which_folder_it_was_written_to(episode, recorded) -> None:
    assert episode.settings["recorders"]["dataset_export_dir_path"] == recorded.name
    assert str(recorded) not in str(episode.settings)


def test_replay_is_the_same_bit_for_bit(episode, again) -> None:
    result = replay(again, episode)
    assert result.is_exact and result.steps == 14 and result.has_end, str(result)
    assert {"poses/tip_pos_w", "wall/positions", "forces/window", "final_state/nodal_vel"} <= set(result.compared)


def test_what_is_changed_shows(episode, again) -> None:
    other = {**episode.data, "actions": episode.data["actions"].copy()}
    other["actions"][9, 0] *= -0.5
    result = replay(again, dataclasses.replace(episode, data=other))
    assert not result.is_exact and result.differences[0].step == 9
    assert "final_state/joint_q" in {one.name for one in result.differences}
    slippery = {**episode.data, "world_settings/friction": np.float32(0.5)}
    assert not replay(again, dataclasses.replace(episode, data=slippery)).is_exact


def test_a_roll_to_and_fro_goes_on_where_a_piece_begins(make_cfg, tmp_path) -> None:
    """A mark after 6 of 9 steps; the whole episode and the piece behind the mark are made again."""
    cfg = make_cfg()
    cfg.recorders = mdp.TrajectoryRecorderCfg(dataset_export_dir_path=str(tmp_path))
    cfg.actions.capsule.roll_amplitude, cfg.actions.capsule.roll_period = 9.0, 2.0
    env = gym.make("ARC-Splenic-Capsule", cfg=cfg).unwrapped
    env.reset()
    mark = {}
    for step in range(9):
        if step == 6:
            mark = {f"{STATE}{name}": array.numpy().copy() for name, array in env.sim.world_arrays().items()}
        env.step(torch.tensor([[0.0, 0.0, 1.0, 0.1, 0.0, 0.0]]))
    env.close()
    whole = Episode.load(episode_paths(tmp_path)[0])
    marked = dataclasses.replace(whole, data={**whole.data, **mark, "marks/step": np.array([6])})
    task, restored = restored_cfg(whole, None, "cpu")
    assert restored.actions.capsule.roll_amplitude == 9.0
    again = gym.make(task, cfg=restored).unwrapped
    assert replay(again, whole).is_exact
    (piece,) = replay_pieces(again, marked)
    assert piece.is_exact and (piece.start, piece.end) == (6, 9), str(piece)
    again.close()


def test_recording_cut_off_by_a_kill_is_compared_as_far_as_it_goes(episode, again) -> None:
    data = {name: value[:10] if name in episode.steps else value for name, value in episode.data.items()}
    cut = {name: value for name, value in data.items() if not name.startswith("final_state/")}
    result = replay(again, dataclasses.replace(episode, data=cut, info={**episode.info, "length": 10}))
    assert result.is_exact and not result.has_end and "no state at the end" in str(result)


def test_mismatches_are_said(episode) -> None:
    _, cfg = restored_cfg(episode, None, "cpu")
    assert mismatches(episode, cfg) == []
    _, other = restored_cfg(episode, None, "cpu", ["env.sim.gravity=[0.0,0.0,-9.0]"])
    old = {
        **episode.provenance,
        "versions": {**episode.provenance["versions"], "newton": "1.0"},
        "stages": {"colon": {"path": "elsewhere", "sha256": "0123"}},
        "device": "cuda:0",
    }
    lines = "\n".join(mismatches(dataclasses.replace(episode, provenance=old), other))
    for text in ("newton 1.0 there", "is not the one recorded", "env.sim.gravity was", "recorded on cuda:0"):
        assert text in lines


def test_wrong_tasks_and_actions_are_named(episode, again, recorded) -> None:
    with pytest.raises(UsageError, match="names no task.*pass --task"):
        restored_cfg(dataclasses.replace(episode, provenance={}), None, "cpu")
    short = dataclasses.replace(episode, data={**episode.data, "actions": episode.data["actions"][:, :4]})
    with pytest.raises(UsageError, match="actions of 4 values, expected actions of 6 values"):
        replay(again, short)
    no_start = {name: value for name, value in episode.data.items() if not name.startswith("initial_state/")}
    with pytest.raises(UsageError, match="no initial_state"):
        replay(again, dataclasses.replace(episode, data=no_start))


def test_command_draws_and_judges(recorded, tmp_path, capsys) -> None:
    path, video = episode_paths(recorded)[0], tmp_path / "again.mp4"
    small = ["env.viewer.outside.width=64", "env.viewer.outside.height=64"]
    assert main(["replay", str(path), "--device", "cpu", "--video", str(video), "--every", "5", *small]) == 0
    assert "outcome: the same, bit for bit" in capsys.readouterr().out
    assert imageio_ffmpeg.count_frames_and_secs(str(video))[0] == 3  # of steps 0, 5 and 10 of 14
    episode = Episode.load(path)
    episode.data["actions"][0] = 0.0
    changed = save_episode(episode, tmp_path / "changed_000000.hdf5")
    assert main(["replay", str(changed), "--device", "cpu"]) == 1
    assert "outcome: NOT the same" in capsys.readouterr().out


def test_command_names_what_it_cannot_read(tmp_path, capsys) -> None:
    for words, message in (
        (["replay", "a.hdf5", "--video", "a.mp4", "--pieces"], "--pieces draws no video: choose one of the two"),
        (["replay", str(tmp_path / "no.hdf5")], "There is no recording"),
        (["replay", str(tmp_path / "no.hdf5"), "--video", "a.avi"], "expected a name that ends in .mp4"),
    ):
        with pytest.raises(SystemExit):
            main(words)
        assert message in capsys.readouterr().err
