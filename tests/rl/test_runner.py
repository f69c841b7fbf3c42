# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import os
import signal

import pytest
import torch

from arcgym.rl import OnPolicyRunner, RslRlVecEnvWrapper, TrainingInterrupted


def make_runner(env, cfg, log_dir) -> OnPolicyRunner:
    return OnPolicyRunner(RslRlVecEnvWrapper(env), cfg.to_dict(), log_dir=str(log_dir), device="cpu")


def signal_at_step(env, step: int, number: int) -> None:
    """Make ``env`` send ``number`` to this process in its ``step``-th step."""
    original = env.step

    def stepped(action):
        result = original(action)
        if env.common_step_counter == step:
            os.kill(os.getpid(), number)
        return result

    env.step = stepped


def test_rollout_keeps_images_as_bytes(counting_env, agent_cfg, tmp_path):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    runner.learn(1)
    stored = runner.alg.storage.observations["policy"]
    assert stored.dtype == torch.uint8
    assert stored[:, 0, 0, 0, 0].tolist() == [0, 1, 2, 3]


def test_checkpoint_counts_iterations_and_steps(counting_env, agent_cfg, tmp_path):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    runner.learn(2)
    resumed = make_runner(counting_env, agent_cfg, tmp_path / "next")
    counting_env.common_step_counter = 0
    infos = resumed.load(str(tmp_path / "model_1.pt"))
    assert infos["completed_iterations"] == resumed.current_learning_iteration == 2
    assert counting_env.common_step_counter == 8
    assert not list(tmp_path.glob("*.tmp"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_leaves_a_checkpoint_that_resumes(counting_env, agent_cfg, tmp_path, number):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    signal_at_step(counting_env, 6, number)
    with pytest.raises(TrainingInterrupted):
        runner.learn(10)
    resumed = make_runner(counting_env, agent_cfg, tmp_path / "next")
    resumed.load(str(tmp_path / "model_0.pt"))
    for name, value in runner.alg.actor.state_dict().items():
        assert torch.equal(value, resumed.alg.actor.state_dict()[name])
    resumed.learn(1)
    assert (tmp_path / "next" / "model_1.pt").is_file()


def test_signal_during_an_update_waits_for_its_end(counting_env, agent_cfg, tmp_path):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    update, ended = runner.alg.update, []

    def interrupted_update():
        os.kill(os.getpid(), signal.SIGINT)
        ended.append(update())
        return ended[-1]

    runner.alg.update = interrupted_update
    with pytest.raises(TrainingInterrupted):
        runner.learn(10)
    assert len(ended) == runner.completed_iterations == 1


def test_best_checkpoint_follows_the_reward(counting_env, agent_cfg, tmp_path):
    runner = make_runner(counting_env, agent_cfg, tmp_path)
    runner.logger.rewbuffer.append(1.0)
    runner.save(str(tmp_path / "model_0.pt"))
    first = (tmp_path / "model_best.pt").read_bytes()
    runner.logger.rewbuffer[0] = 0.5
    runner.completed_iterations = 7
    runner.save(str(tmp_path / "model_1.pt"))
    assert (tmp_path / "model_best.pt").read_bytes() == first
