# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a new run takes over from another run's checkpoint, and what learns first."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread


def make_runner(seed: int, **changes) -> OnPolicyRunner:
    torch.manual_seed(seed)
    return OnPolicyRunner(SteerToDot(4), runner_cfg(**changes).to_dict(), device="cpu")


def same(first: dict[str, torch.Tensor], second: torch.nn.Module) -> bool:
    return all(torch.equal(value, first[name]) for name, value in second.state_dict().items())


def copied(model: torch.nn.Module) -> dict[str, torch.Tensor]:
    return {name: value.clone() for name, value in model.state_dict().items()}


@one_thread()
def test_the_critic_learns_first(tmp_path):
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, init_policy=str(tmp_path / "model_0.pt"), critic_first=2)
    critic = copied(runner.alg.critic)
    runner.learn(2)
    assert same(copied(first.alg.actor), runner.alg.actor)
    assert not same(critic, runner.alg.critic)
    runner.learn(1)
    assert not same(copied(first.alg.actor), runner.alg.actor)


@one_thread()
def test_a_distilled_student_is_a_policy(tmp_path):
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    contents = torch.load(tmp_path / "model_0.pt", weights_only=True)
    contents["student_state_dict"] = contents.pop("actor_state_dict")
    torch.save(contents, tmp_path / "student.pt")
    runner = make_runner(seed=1, init_policy=str(tmp_path / "student.pt"), critic_first=1)
    runner.learn(1)
    assert same(copied(first.alg.actor), runner.alg.actor)


@one_thread()
def test_a_deviation_that_is_fixed_stays_so(tmp_path):
    distribution = GaussianDistributionCfg(init_std=0.3, learn_std=False)
    actor = runner_cfg().actor.replace(distribution_cfg=distribution)
    make_runner(seed=0, actor=actor).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=actor, init_policy=str(tmp_path / "model_0.pt"), critic_first=1)
    runner.learn(2)
    assert float(runner.alg.actor.output_std.mean()) == pytest.approx(0.3)


@one_thread()
def test_without_another_runs_policy_all_learn_at_once():
    runner = make_runner(seed=1, critic_first=2)
    actor = copied(runner.alg.actor)
    runner.learn(1)
    assert not same(actor, runner.alg.actor)


def test_a_checkpoint_of_another_policy_is_named(tmp_path):
    make_runner(
        seed=0,
        actor=RslRlMlpModelCfg(hidden_dims=[8], distribution_cfg=GaussianDistributionCfg()),
        obs_groups={"actor": ["critic"], "critic": ["critic"]},
    ).save(str(tmp_path / "other.pt"))
    runner = make_runner(seed=1, init_policy=str(tmp_path / "other.pt"))
    with pytest.raises(UsageError, match="init_policy=.*other.pt does not fit the policy"):
        runner.learn(0)
