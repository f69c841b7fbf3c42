# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot, mean_reward
from small_agents import actor_cfg, runner_cfg, with_memory

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.rl.agent_cfgs.imitation import RslRlDistillationAlgorithmCfg, RslRlDistillationRunnerCfg
from arcgym.rl.distillation_runner import DistillationRunner
from arcgym.utils.threads import one_thread


def teacher_cfg() -> RslRlMlpModelCfg:
    return RslRlMlpModelCfg(hidden_dims=[16], distribution_cfg=GaussianDistributionCfg(init_std=0.5))


def make_runner(teacher_checkpoint: str = "", num_envs: int = 64, **changes) -> DistillationRunner:
    torch.manual_seed(1)
    cfg = RslRlDistillationRunnerCfg(
        teacher_checkpoint=teacher_checkpoint,
        num_steps_per_env=8,
        student=actor_cfg(),
        teacher=teacher_cfg(),
        algorithm=RslRlDistillationAlgorithmCfg(learning_rate=3e-3),
    ).replace(**changes)
    return DistillationRunner(SteerToDot(num_envs), cfg.to_dict(), device="cpu")


@pytest.fixture(scope="module")
def teacher_checkpoint(tmp_path_factory) -> str:
    """A privileged policy after a few updates of PPO."""
    with one_thread():
        torch.manual_seed(0)
        cfg = runner_cfg(actor=teacher_cfg(), obs_groups={"actor": ["critic"], "critic": ["critic"]})
        runner = OnPolicyRunner(SteerToDot(128), cfg.to_dict(), device="cpu")
        runner.learn(15)
        path = tmp_path_factory.mktemp("teacher") / "model_14.pt"
        runner.save(str(path))
    return str(path)


@one_thread()
def test_student_learns_from_images(teacher_checkpoint, tmp_path):
    runner = make_runner(teacher_checkpoint)
    runner.learn(20)
    policy = runner.get_inference_policy()
    assert mean_reward(SteerToDot(64, seed=1), policy, 80) > 0.7
    runner.save(str(tmp_path / "model_19.pt"))
    player = make_runner()
    player.load(str(tmp_path / "model_19.pt"), load_cfg={"actor": True})
    obs = SteerToDot(4).get_observations()
    torch.testing.assert_close(player.get_inference_policy()(obs), policy(obs))


@one_thread()
def test_resumed_run_brings_its_teacher(teacher_checkpoint, tmp_path):
    runner = make_runner(teacher_checkpoint)
    runner.learn(1)
    runner.save(str(tmp_path / "model_0.pt"))
    resumed = make_runner()
    resumed.load(str(tmp_path / "model_0.pt"))
    resumed.learn(1)
    assert resumed.completed_iterations == 2


@one_thread()
@pytest.mark.parametrize("memory", [0, 4])
def test_a_student_begins_as_another_runs_policy(teacher_checkpoint, tmp_path, memory: int) -> None:
    """Of a student with a memory the weights that read it begin at nought, so that it acts as that policy does."""
    first = OnPolicyRunner(SteerToDot(4), runner_cfg().to_dict(), device="cpu")
    first.save(str(tmp_path / "model_0.pt"))
    student = with_memory(rnn_hidden_dim=memory) if memory else actor_cfg()
    runner = make_runner(teacher_checkpoint, 4, student=student, init_policy=str(tmp_path / "model_0.pt"))
    runner.learn(0)
    obs = SteerToDot(4).get_observations()
    torch.testing.assert_close(runner.get_inference_policy()(obs), first.get_inference_policy()(obs))
    runner.learn(1)


@one_thread()
def test_a_teacher_may_see_images_beside_the_state(tmp_path) -> None:
    """As ``ppo_teacher_rgb``: its vectors are normalized as it learnt to, which the student's run takes over."""
    teacher, groups = runner_cfg().actor.replace(obs_normalization=True), ["policy", "critic"]
    cfg = runner_cfg(actor=teacher, obs_groups={"actor": groups, "critic": ["critic"]})
    first = OnPolicyRunner(SteerToDot(4), cfg.to_dict(), device="cpu")
    first.learn(1)
    first.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(
        str(tmp_path / "model_0.pt"), 4, teacher=teacher, obs_groups={"student": ["policy"], "teacher": groups}
    )
    runner.learn(1)
    obs = SteerToDot(4).get_observations()
    torch.testing.assert_close(runner.alg.teacher(obs), first.get_inference_policy()(obs))


def test_teacher_must_be_given():
    with pytest.raises(ValueError, match="agent.teacher_checkpoint"):
        make_runner().learn(1)


def test_missing_teacher_is_named():
    with pytest.raises(ValueError, match="nowhere.pt"):
        make_runner("nowhere.pt").learn(1)
