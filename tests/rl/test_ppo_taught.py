# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO with a teacher: the arithmetic of its lesson, and that it is followed, fades and is resumed."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import actor_cfg, roll_and_update, runner_cfg, with_memory

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.rl.agent_cfgs.ppo_taught import RslRlPpoTaughtAlgorithmCfg, RslRlTaughtRunnerCfg
from arcgym.rl.algorithms.ppo_taught import lesson_loss
from arcgym.rl.taught_runner import TaughtRunner
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

TEACHER = RslRlMlpModelCfg(hidden_dims=[16], distribution_cfg=GaussianDistributionCfg(init_std=0.5))


def make_runner(teacher_checkpoint: str = "", actor=None, num_envs: int = 4, **algorithm) -> TaughtRunner:
    torch.manual_seed(1)
    settings = {"learning_rate": 3e-3, "schedule": "fixed", "gamma": 0.8, "entropy_coef": 0.0, "num_mini_batches": 2}
    cfg = RslRlTaughtRunnerCfg(
        teacher_checkpoint=teacher_checkpoint,
        num_steps_per_env=8,
        max_iterations=5,
        actor=actor or actor_cfg(),
        critic=RslRlMlpModelCfg(hidden_dims=[32]),
        teacher=TEACHER,
        algorithm=RslRlPpoTaughtAlgorithmCfg(**(settings | algorithm)),
        init_at_random_ep_len=False,
    )
    return TaughtRunner(SteerToDot(num_envs), cfg.to_dict(), device="cpu")


@pytest.fixture(scope="module")
def teacher_checkpoint(tmp_path_factory) -> str:
    """A policy that sees the state; nobody has trained it."""
    torch.manual_seed(0)
    cfg = runner_cfg(actor=TEACHER, obs_groups={"actor": ["critic"], "critic": ["critic"]})
    path = tmp_path_factory.mktemp("teacher") / "model_0.pt"
    OnPolicyRunner(SteerToDot(4), cfg.to_dict(), device="cpu").save(str(path))
    return str(path)


def test_loss_by_hand():
    """(1 + 4) for the first row and 0 for the second, of two rows."""
    assert lesson_loss(torch.tensor([[1.0, 2.0], [3.0, 0.5]]), torch.tensor([[0.0, 0.0], [3.0, 0.5]])).item() == 2.5


@one_thread()
@pytest.mark.parametrize("memory", [False, True])
def test_each_step_is_taught_what_the_teacher_does_there(teacher_checkpoint, memory: bool) -> None:
    """With a rate of next to nothing the reported loss is that of the rollout, whatever the order of mini-batches."""
    runner = make_runner(teacher_checkpoint, with_memory() if memory else None, learning_rate=1e-12)
    runner.learn(0)
    alg, errors = runner.alg, []
    act = alg.act

    def watched(obs):
        actions = act(obs)
        lesson = alg.teacher(obs).clamp(-1.0, 1.0)
        errors.append(lesson_loss(alg.actor.output_distribution_params[0], lesson))
        return actions

    alg.act = watched
    losses = roll_and_update(runner)
    assert losses["lesson"] == pytest.approx(torch.stack(errors).mean().item(), rel=1e-4)


@one_thread()
@pytest.mark.parametrize(("coef", "near"), [(10.0, True), (0.0, False)])
def test_a_lesson_is_followed(teacher_checkpoint, coef: float, near: bool) -> None:
    runner = make_runner(teacher_checkpoint, num_envs=64, lesson_coef=coef)
    runner.learn(0)
    first = roll_and_update(runner)["lesson"]
    for _ in range(25):
        last = roll_and_update(runner)["lesson"]
    assert (last < 0.5 * first) == near


@one_thread()
def test_the_lesson_fades_and_the_teacher_does_not_learn(teacher_checkpoint) -> None:
    runner = make_runner(teacher_checkpoint, lesson_coef=1.0, final_lesson_coef=0.2)
    runner.learn(0)
    before = {name: value.clone() for name, value in runner.alg.teacher.state_dict().items()}
    runner.learn(3)
    assert runner.alg.lesson_coef == pytest.approx(0.6)  # the third of five updates
    runner.learn(2)
    assert runner.alg.lesson_coef == pytest.approx(0.2)
    assert all(torch.equal(value, before[name]) for name, value in runner.alg.teacher.state_dict().items())


@one_thread()
def test_a_resumed_run_brings_its_teacher(teacher_checkpoint, tmp_path) -> None:
    runner = make_runner(teacher_checkpoint)
    runner.learn(1)
    runner.save(str(tmp_path / "model_0.pt"))
    resumed = make_runner()
    resumed.load(str(tmp_path / "model_0.pt"))
    resumed.learn(1)
    player = make_runner()
    player.load(str(tmp_path / "model_0.pt"), load_cfg={"actor": True})
    obs = SteerToDot(4).get_observations()
    torch.testing.assert_close(player.get_inference_policy()(obs), runner.get_inference_policy()(obs))


@pytest.mark.parametrize("path", ["", "nowhere.pt"])
def test_a_teacher_must_be_there(path: str) -> None:
    with pytest.raises(UsageError, match=path or "set agent.teacher_checkpoint"):
        make_runner(path).learn(1)


def test_a_teacher_of_another_shape_is_named(tmp_path) -> None:
    OnPolicyRunner(SteerToDot(4), runner_cfg().to_dict(), device="cpu").save(str(tmp_path / "images.pt"))
    with pytest.raises(UsageError, match=r"images.pt does not fit agent.teacher: "):
        make_runner(str(tmp_path / "images.pt")).learn(1)
