# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a training run leaves on disk: alone, as a process of torchrun, and after a start that failed."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from arcgym.rl import OnPolicyRunner, RslRlVecEnvWrapper, training
from arcgym.rl.divergence import TrainingDiverged
from arcgym.rl.training import TrainOptions, train
from arcgym.utils.errors import UsageError

TASK = "ARC-Rectum-Capsule"
VIDEO = TrainOptions(device="cpu", video_interval=10)


class QuietRunner(OnPolicyRunner):
    """Runner that makes no group of processes."""

    def _configure_multi_gpu(self):
        self.gpu_world_size, self.gpu_global_rank, self.is_distributed = 1, 0, False
        self.cfg["multi_gpu"] = None


@pytest.fixture
def start(counting_env, agent_cfg, tmp_path, monkeypatch):
    """Function that trains in ``counting_env`` and returns the exit status and the videos asked for."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(training, "check_run", lambda *_, **__: None)
    monkeypatch.setattr(training, "check_launcher", lambda *_: None)
    counting_env.summary = lambda: "the managers"
    agent_cfg.class_name = QuietRunner
    env_cfg = SimpleNamespace(log_dir=None, seed=None, sim=SimpleNamespace(device="cpu"))
    videos = []

    def make_env(task, env_cfg, agent_cfg, video):
        videos.append(video)
        return RslRlVecEnvWrapper(counting_env)

    monkeypatch.setattr(training, "make_env", make_env)
    monkeypatch.setattr(training, "write_params", lambda folder, **cfgs: (folder / "params").mkdir())
    return lambda: (train(TASK, env_cfg, agent_cfg, VIDEO), videos[0])


def test_a_run_leaves_params_curves_and_checkpoints(start, tmp_path, capsys):
    status, video = start()
    (run,) = (tmp_path / "logs/rsl_rl/arcgym").iterdir()
    names = {path.name.split(".")[0] for path in run.iterdir()}
    assert (status, video.folder) == (0, run / "videos" / "train")
    assert {"params", "model_0", "model_1", "events"} <= names
    output = capsys.readouterr().out
    assert "the managers" in output and f"checkpoint: {run / 'model_1.pt'}" in output
    assert "Linear(" not in output


def test_other_ranks_write_and_print_nothing(start, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("RANK", "1")
    assert start() == (0, None)
    assert not list(tmp_path.iterdir())
    assert capsys.readouterr().out == ""


def test_failed_start_leaves_no_folder(start, tmp_path, monkeypatch):
    def fail(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(training, "make_env", fail)
    with pytest.raises(KeyboardInterrupt):
        start()
    assert not list((tmp_path / "logs/rsl_rl/arcgym").iterdir())


def test_divergence_is_an_exit_status_and_a_line(start, monkeypatch, capsys):
    def diverge(*_):
        raise TrainingDiverged("iteration 3: loss 'value' is nan")

    monkeypatch.setattr(QuietRunner, "learn", diverge)
    assert start()[0] == 1
    assert "training stopped in iteration 3: loss 'value' is nan." in capsys.readouterr().err


def test_torchrun_and_the_flag_belong_together(monkeypatch):
    monkeypatch.setenv("WORLD_SIZE", "2")
    with pytest.raises(UsageError, match="torchrun started 2 processes; add --distributed"):
        train(TASK, None, None, TrainOptions())
