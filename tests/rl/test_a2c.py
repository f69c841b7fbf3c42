# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import copy

import pytest
import torch
from pixel_tasks import SteerToDot, mean_reward
from small_agents import runner_cfg

from arcgym.rl import OnPolicyRunner, RslRlPpoAlgorithmCfg
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.utils.threads import one_thread


def make_runner(algorithm, num_envs: int = 4, **changes) -> OnPolicyRunner:
    torch.manual_seed(0)
    return OnPolicyRunner(SteerToDot(num_envs), runner_cfg(algorithm=algorithm, **changes).to_dict(), device="cpu")


def roll(runner, steps: int = 8) -> None:
    """Fill the storage and compute the returns."""
    torch.manual_seed(1)
    obs = runner.env.get_observations()
    with torch.inference_mode():
        for _ in range(steps):
            obs, rewards, dones, extras = runner.env.step(runner.alg.act(obs))
            runner.alg.process_env_step(obs, rewards, dones, extras)
        runner.alg.compute_returns(obs)


def test_step_is_the_policy_gradient():
    """One step of plain gradient descent on -mean(A log p) + 0.5 mean((R - V)^2)."""
    alg = (runner := make_runner(RslRlA2cAlgorithmCfg(optimizer="sgd", learning_rate=0.1, max_grad_norm=1e9))).alg
    roll(runner)
    actor, critic, st = copy.deepcopy(alg.actor), copy.deepcopy(alg.critic), alg.storage
    obs, actions = st.observations.flatten(0, 1), st.actions.flatten(0, 1)
    actor(obs, stochastic_output=True)
    returns, values = st.returns.flatten(0, 1), st.values.flatten(0, 1)
    policy_loss = -((returns - values)[:, 0] * actor.get_output_log_prob(actions)).mean()
    (policy_loss + 0.5 * (returns - critic(obs)).square().mean()).backward()
    expected = [p - 0.1 * p.grad for model in (actor, critic) for p in model.parameters()]
    alg.update()
    for got, want in zip([*alg.actor.parameters(), *alg.critic.parameters()], expected, strict=True):
        torch.testing.assert_close(got, want, rtol=1e-4, atol=1e-6)


def test_equals_ppo_of_one_epoch_and_batch():
    """With scaled advantages the two differ in nothing but the order of two sums."""
    common = {"optimizer": "sgd", "learning_rate": 0.1, "normalize_advantage_per_mini_batch": True}
    a2c = make_runner(RslRlA2cAlgorithmCfg(**common))
    shared = {k: v for k, v in a2c.cfg["algorithm"].items() if k not in ("class_name", "optimizer_eps")}
    ppo = make_runner(RslRlPpoAlgorithmCfg(**shared))
    for runner in (a2c, ppo):
        roll(runner)
        runner.alg.update()
    for ours, theirs in zip(a2c.alg.actor.parameters(), ppo.alg.actor.parameters(), strict=True):
        torch.testing.assert_close(ours, theirs)


def test_several_epochs_are_refused():
    with pytest.raises(ValueError, match="num_learning_epochs is 3, expected 1"):
        make_runner(RslRlA2cAlgorithmCfg(num_learning_epochs=3))


def test_one_iteration_runs():
    runner = make_runner(RslRlA2cAlgorithmCfg())
    runner.learn(1)
    assert runner.completed_iterations == 1


@pytest.mark.parametrize("algorithm, updates", [("a2c", 60), ("ppo", 12)])
@one_thread()
def test_solves_the_dot(algorithm, updates):
    cfg = runner_cfg().algorithm if algorithm == "ppo" else RslRlA2cAlgorithmCfg(learning_rate=1e-3, gamma=0.8)
    runner = make_runner(cfg, num_envs=128)
    before = mean_reward(SteerToDot(64), runner.get_inference_policy(), 80)
    runner.learn(updates)
    assert mean_reward(SteerToDot(64), runner.get_inference_policy(), 80) > 0.75 > before + 0.3
