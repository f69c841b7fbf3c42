# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot, mean_reward
from test_sac import make_batch, runner_cfg

from arcgym.rl.agent_cfgs.sac import RslRlDistributionalSacAlgorithmCfg
from arcgym.rl.algorithms.distributional_sac import project
from arcgym.rl.off_policy_runner import OffPolicyRunner
from arcgym.utils.threads import one_thread

SUPPORT = torch.tensor([0.0, 1.0, 2.0])


def make_runner(num_envs: int = 8, **algorithm) -> OffPolicyRunner:
    torch.manual_seed(0)
    base = runner_cfg().algorithm
    shared = {name: getattr(base, name) for name in vars(base) if name != "class_name"}
    settings = shared | {"num_atoms": 21, "value_range": [-2.0, 6.0]} | algorithm
    cfg = runner_cfg().replace(algorithm=RslRlDistributionalSacAlgorithmCfg(**settings))
    return OffPolicyRunner(SteerToDot(num_envs), cfg.to_dict(), device="cpu")


def test_projection_shares_by_nearness_and_cuts_off():
    """0.25 is three quarters atom 0 and one quarter atom 1; 1 is atom 1; 5 is the last atom."""
    values, chances = torch.tensor([[0.25, 1.0, 5.0]]), torch.tensor([[0.4, 0.5, 0.1]])
    torch.testing.assert_close(project(values, chances, SUPPORT), torch.tensor([[0.3, 0.6, 0.1]]))


def test_projection_keeps_the_mean_inside_the_range():
    torch.manual_seed(0)
    values, chances = 2.0 * torch.rand(50, 3), torch.rand(50, 3).softmax(dim=1)
    projected = project(values, chances, SUPPORT)
    torch.testing.assert_close(projected @ SUPPORT, (values * chances).sum(dim=1))
    torch.testing.assert_close(projected.sum(dim=1), torch.ones(50))


def test_target_mean_is_that_of_plain_sac(monkeypatch):
    """Uniform critics on -2 ... 6 mean 2; reward 1, discount and temperature 0.5, log-probability -1: 1 + 0.5 x 2.5."""
    alg = make_runner(gamma=0.5, init_temperature=0.5).alg
    for target in alg.targets:
        target.mlp[-1].weight.data.zero_()
        target.mlp[-1].bias.data.zero_()
    monkeypatch.setattr(alg, "_sample", lambda obs: (torch.zeros(2, 2), torch.full((2,), -1.0)))
    batch = make_batch([0.0, 1.0], gamma=0.5)
    torch.testing.assert_close(alg.target_distribution(batch) @ alg.support, torch.tensor([2.25, 1.0]))
    torch.testing.assert_close(alg.targets_of(batch), torch.tensor([2.25, 1.0]))


def test_critic_with_the_smaller_mean_is_the_target():
    alg = make_runner(gamma=1.0, init_temperature=1e-9).alg
    for target, atom in zip(alg.targets, (20, 5), strict=True):
        target.mlp[-1].weight.data.zero_()
        target.mlp[-1].bias.data.zero_()
        target.mlp[-1].bias.data[atom] = 50.0
    batch = make_batch([0.0])
    expected = float(alg.support[5]) + 1.0
    assert float(alg.target_distribution(batch)[0] @ alg.support) == pytest.approx(expected, abs=1e-4)


def test_empty_range_is_refused():
    with pytest.raises(ValueError, match="expected 2 atoms or more, rising"):
        make_runner(value_range=[1.0, 1.0])


@one_thread()
def test_learning_lowers_the_critics_loss():
    runner = make_runner(learning_starts=64)
    runner.learn(2)
    torch.manual_seed(0)
    batch = runner.alg.replay.sample(64)
    before = float(runner.alg.critic_loss(batch).detach())
    for _ in range(30):
        runner.alg.step_on(batch)
    assert float(runner.alg.critic_loss(batch).detach()) < before


@pytest.mark.slow
@one_thread()
def test_solves_the_dot():
    runner = make_runner(num_envs=32)
    runner.learn(32)
    assert mean_reward(SteerToDot(64), runner.get_inference_policy(), 80) > 0.75
