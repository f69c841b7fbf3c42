# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import errno
import os
import pickle

import pytest
import torch

from arcgym.rl import OnPolicyRunner, RslRlVecEnvWrapper
from arcgym.rl.checkpoint import read_checkpoint, write_checkpoint
from arcgym.rl.divergence import TrainingDiverged, check_finite
from arcgym.rl.patient_writer import PatientWriter
from arcgym.utils.errors import UsageError


class Bomb:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = str(path)

    def __reduce__(self):
        return (open, (self.path, "w"))


def full_disk(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def make_runner(env, cfg, log_dir) -> OnPolicyRunner:
    return OnPolicyRunner(RslRlVecEnvWrapper(env), cfg.to_dict(), log_dir=str(log_dir), device="cpu")


@pytest.mark.parametrize("save", [torch.save, lambda value, path: path.write_bytes(pickle.dumps(value))])
def test_foreign_checkpoint_runs_no_code(tmp_path, save):
    save({"infos": {}, "actor_state_dict": Bomb(tmp_path / "ran")}, tmp_path / "model_0.pt")
    with pytest.raises(UsageError, match="model_0.pt cannot be loaded as weights"):
        read_checkpoint(tmp_path / "model_0.pt")
    assert not (tmp_path / "ran").exists()


def test_other_files_are_no_checkpoints(tmp_path):
    torch.save({"weights": torch.zeros(2)}, tmp_path / "other.pt")
    with pytest.raises(UsageError, match="no checkpoint of a training run"):
        read_checkpoint(tmp_path / "other.pt")


def test_other_networks_are_named(counting_env, agent_cfg, tmp_path):
    make_runner(counting_env, agent_cfg, tmp_path).save(str(tmp_path / "model_0.pt"))
    agent_cfg.critic.hidden_dims = [9]
    with pytest.raises(UsageError, match="does not fit the agent"):
        make_runner(counting_env, agent_cfg, tmp_path).load(str(tmp_path / "model_0.pt"))


def test_full_disk_keeps_the_last_whole_checkpoint(tmp_path, monkeypatch, capsys):
    path = tmp_path / "model_0.pt"
    assert write_checkpoint(path, {"infos": {"kept": 1}})
    monkeypatch.setattr(os, "fsync", full_disk)
    assert not write_checkpoint(path, {"infos": {"kept": 2}})
    assert read_checkpoint(path)["infos"] == {"kept": 1}
    assert [file.name for file in tmp_path.iterdir()] == ["model_0.pt"]
    assert "No space left on device" in capsys.readouterr().out


def test_training_goes_on_with_a_full_disk(counting_env, agent_cfg, tmp_path, monkeypatch):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    runner.learn(1)
    monkeypatch.setattr(os, "fsync", full_disk)
    runner.learn(2)
    assert runner.completed_iterations == 3
    assert runner.last_checkpoint == tmp_path / "model_0.pt"
    assert not (tmp_path / "model_1.pt").exists()


def test_curves_stop_at_a_full_disk(capsys):
    class Writer:
        log_dir, calls = "logs", 0

        def add_scalar(self, *_):
            self.calls += 1
            full_disk()

    writer = PatientWriter(Writer())
    writer.add_scalar("Loss/value", 1.0, 0)
    writer.add_scalar("Loss/value", 1.0, 1)
    assert writer.calls == 1
    assert capsys.readouterr().out.count("No space left on device; training goes on") == 1


def test_divergence_names_loss_weights_and_iteration():
    weights = {"critic": [torch.tensor([1.0, float("inf")])], "actor": [torch.ones(2)]}
    with pytest.raises(TrainingDiverged, match="iteration 4: loss 'value' is nan, weights of the critic are not"):
        check_finite({"value": float("nan"), "entropy": 1.0}, weights, 4)
    check_finite({"value": 1.0, "episode_cost/total": float("nan")}, {"actor": [torch.ones(2)]}, 4)


def test_nan_loss_stops_before_it_is_saved(counting_env, agent_cfg, tmp_path):
    agent_cfg.save_interval = 1
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    runner.learn(1)
    with torch.no_grad():
        runner.alg.critic.mlp[0].weight.fill_(float("nan"))
    with pytest.raises(TrainingDiverged, match="iteration 1: weights of the actor are not finite"):
        runner.learn(5)
    assert runner.last_checkpoint == tmp_path / "model_0.pt"
    assert {path.name for path in tmp_path.glob("*.pt")} <= {"model_0.pt", "model_best.pt"}
