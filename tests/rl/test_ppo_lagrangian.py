# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import math

import pytest
import torch
from pixel_tasks import PayForSpeed, SteerToDot
from small_agents import runner_cfg

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.rl.agent_cfgs.ppo_lagrangian import (
    AscentMultiplierCfg,
    FixedPenaltyCfg,
    PidMultiplierCfg,
    RslRlPpoLagrangianAlgorithmCfg,
    RslRlPpoLagrangianRunnerCfg,
)
from arcgym.rl.episode_costs import EpisodeCosts
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

LIMIT = 0.25


def make_runner(env, algorithm=None, log_dir=None, **changes) -> OnPolicyRunner:
    torch.manual_seed(0)
    algorithm = algorithm or RslRlPpoLagrangianAlgorithmCfg(limits={"effort": 1.0})
    base = runner_cfg(**changes).replace(algorithm=algorithm)
    cfg = RslRlPpoLagrangianRunnerCfg(**{name: getattr(base, name) for name in vars(base)})
    return OnPolicyRunner(env, cfg.to_dict(), log_dir=log_dir, device="cpu")


def roll(runner, steps: int = 8) -> None:
    obs = runner.env.get_observations()
    with torch.inference_mode():
        for _ in range(steps):
            obs, rewards, dones, extras = runner.env.step(runner.alg.act(obs))
            runner.alg.process_env_step(obs, rewards, dones, extras)
        runner.alg.compute_returns(obs)


def test_fixed_penalty_is_ppo_on_the_penalised_reward():
    """Critics are linear in what they estimate, so that with zero critics both advantages are plain sums."""
    algorithm = RslRlPpoLagrangianAlgorithmCfg(
        limits={"effort": 1.0}, multiplier=FixedPenaltyCfg(init=0.3), gamma=0.9, cost_gamma=0.9, cost_lam=0.95
    )
    alg = (runner := make_runner(SteerToDot(4), algorithm)).alg
    for parameter in (*alg.critic.parameters(), *alg.cost_critics.parameters()):
        parameter.data.zero_()
    roll(runner)
    penalised = alg.storage.rewards - 0.3 * alg.costs[0]
    expected, following = torch.zeros_like(penalised), torch.zeros(4, 1)
    for step in reversed(range(8)):
        following = penalised[step] + 0.9 * 0.95 * following * (1 - alg.storage.dones[step].float())
        expected[step] = following
    expected = (expected - expected.mean()) / expected.std()
    torch.testing.assert_close(alg.storage.advantages, expected, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize(
    "multiplier",
    [AscentMultiplierCfg(init=0.0, learning_rate=0.5), PidMultiplierCfg(init=0.0, kp=2.0, ki=0.3)],
    ids=["ascent", "pid"],
)
@one_thread()
def test_policy_meets_the_limit_at_the_known_optimum(multiplier):
    """Reward a, cost a^2 at most 1/4: the mean action is sqrt(1/4 - std^2), the multiplier about 1 / (2 x 1/2) = 1."""
    std = 0.1
    algorithm = RslRlPpoLagrangianAlgorithmCfg(
        limits={"effort": LIMIT},
        multiplier=multiplier,
        learning_rate=3e-3,
        schedule="fixed",
        entropy_coef=0.0,
        cost_gamma=0.99,
    )
    distribution = GaussianDistributionCfg(init_std=std, learn_std=False)
    actor = RslRlMlpModelCfg(hidden_dims=[8], distribution_cfg=distribution)
    runner = make_runner(PayForSpeed(64), algorithm, actor=actor)
    prices, costs = [], []
    runner.learn(60)
    for _ in range(20):
        runner.learn(2)
        prices.append(runner.alg.multipliers["effort"].value)
        costs.append(runner.alg.mean_episode_costs["effort"])
    with torch.inference_mode():
        action = float(runner.get_inference_policy()(PayForSpeed(1).get_observations()))
    assert sum(costs) / 20 == pytest.approx(LIMIT, rel=0.1)
    assert action == pytest.approx(math.sqrt(LIMIT - std**2), rel=0.15)
    assert sum(prices) / 20 == pytest.approx(1.0, rel=0.2)


def test_costs_go_on_after_a_time_out():
    """The episode's last step, a time-out, gets the discounted value of its state on top of its cost."""
    runner = make_runner(SteerToDot(4))
    alg = runner.alg
    with torch.no_grad():
        for model in alg.cost_critics.values():
            model.mlp[-1].weight.zero_()
            model.mlp[-1].bias.fill_(10.0)
    roll(runner)
    effort = alg.storage.actions.square().sum(dim=2, keepdim=True)
    torch.testing.assert_close(alg.costs[0, :7], effort[:7])
    torch.testing.assert_close(alg.costs[0, 7], effort[7] + 0.99 * 10.0)


@one_thread()
def test_checkpoint_resumes_critics_and_multipliers(tmp_path):
    runner = make_runner(SteerToDot(4))
    runner.learn(4)
    runner.save(str(tmp_path / "model_3.pt"))
    resumed = make_runner(SteerToDot(4))
    resumed.load(str(tmp_path / "model_3.pt"))
    assert resumed.alg.multipliers["effort"].state_dict() == runner.alg.multipliers["effort"].state_dict()
    assert resumed.alg.multipliers["effort"].value != 0.001
    for runner_ in (runner, resumed):
        runner_.env, runner_.alg.episode_costs = SteerToDot(4, seed=5), EpisodeCosts(1, 4, "cpu")
        torch.manual_seed(5)
        roll(runner_)
        runner_.alg.update()
    for name, value in runner.alg.save().items():
        assert str(value) == str(resumed.alg.save()[name]), name


def test_unknown_cost_lists_the_known():
    runner = make_runner(SteerToDot(4), RslRlPpoLagrangianAlgorithmCfg(limits={"force": 1.0}))
    with pytest.raises(UsageError, match="'force'; the task's are: effort, total"):
        roll(runner)


def test_plain_checkpoint_is_refused(tmp_path):
    torch.manual_seed(0)
    plain = OnPolicyRunner(SteerToDot(4), runner_cfg().to_dict(), device="cpu")
    plain.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(SteerToDot(4))
    with pytest.raises(UsageError, match="not one of PPOLagrangian"):
        runner.load(str(tmp_path / "model_0.pt"))
    runner.load(str(tmp_path / "model_0.pt"), load_cfg={"actor": True})
