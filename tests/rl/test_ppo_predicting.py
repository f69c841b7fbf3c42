# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO that also predicts its critic's observations: the head learns, features help, checkpoints keep it."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import roll_and_update, runner_cfg

from arcgym.rl import OnPolicyRunner, RslRlMlpModelCfg, RslRlPpoAlgorithmCfg, export_policy_as_jit
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

ALGORITHM = RslRlPpoAlgorithmCfg(
    class_name="arcgym.rl.algorithms.ppo_predicting:PPOPredicting",
    learning_rate=3e-3,
    schedule="fixed",
    gamma=0.8,
    entropy_coef=0.0,
)
CRITIC = RslRlMlpModelCfg(hidden_dims=[32], obs_normalization=True)


def _runner(env=None, critic=CRITIC) -> OnPolicyRunner:
    torch.manual_seed(0)
    cfg = runner_cfg(algorithm=ALGORITHM, critic=critic)
    return OnPolicyRunner(env or SteerToDot(16), cfg.to_dict(), device="cpu")


@one_thread()
def test_head_learns_where_the_dot_is():
    """Guesses of normalized numbers are off by a variance of about one; the dot can be seen in every image."""
    runner = _runner()
    losses = [roll_and_update(runner)["prediction"] for _ in range(30)]
    assert max(losses[:4]) > 0.8
    assert sum(losses[-10:]) / 10 < 0.2


@one_thread()
def test_loss_by_hand():
    runner = _runner()
    alg = runner.alg
    obs = runner.env.get_observations()
    with alg.features:
        alg.actor(obs, stochastic_output=True)
    features = torch.nn.functional.elu(alg.actor.mlp[0](alg.actor.get_latent(obs)))
    mean, std = alg.critic.obs_normalizer._mean, alg.critic.obs_normalizer._std
    target = (obs["critic"] - mean) / (std + alg.critic.obs_normalizer.eps)
    expected = (alg.head(features) - target.clamp(-5.0, 5.0)).square().mean()
    batch = type("Batch", (), {"observations": obs})
    torch.testing.assert_close(alg.symmetry.compute_loss(alg.actor, batch, len(obs)), expected)


@one_thread()
def test_checkpoint_keeps_the_head(tmp_path):
    runner = _runner()
    roll_and_update(runner)
    runner.save(str(tmp_path / "model_0.pt"))
    other = _runner()
    assert not torch.equal(other.alg.head.weight, runner.alg.head.weight)
    other.load(str(tmp_path / "model_0.pt"))
    torch.testing.assert_close(other.alg.head.weight, runner.alg.head.weight)


@one_thread()
def test_policy_that_has_learnt_is_exported(tmp_path):
    runner = _runner()
    roll_and_update(runner)
    obs = runner.env.get_observations()
    exported = torch.jit.load(str(export_policy_as_jit(runner.alg.get_policy(), tmp_path)))
    actions = exported(torch.zeros(16, 0), [obs["policy"]])
    torch.testing.assert_close(actions, runner.get_inference_policy()(obs))


def test_scale_is_needed():
    with pytest.raises(UsageError, match="obs_normalization"):
        _runner(critic=RslRlMlpModelCfg(hidden_dims=[32]))
