# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A run that was killed goes on like the one that was not; multipliers and replay have tests of their own."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import ENCODER, actor_cfg, runner_cfg

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.rl.agent_cfgs.image_models import RecurrentCnnModelCfg
from arcgym.utils.threads import one_thread


def recurrent(rnn_type: str) -> RecurrentCnnModelCfg:
    return RecurrentCnnModelCfg(
        hidden_dims=[16],
        cnn_cfg=ENCODER,
        rnn_type=rnn_type,
        rnn_hidden_dim=8,
        distribution_cfg=GaussianDistributionCfg(),
    )


CHANGES = {
    "ppo": {"actor": actor_cfg()},
    "lstm": {"actor": recurrent("lstm")},
    "gru": {"actor": recurrent("gru")},
    "a2c": {"algorithm": RslRlA2cAlgorithmCfg()},
}


def make_runner(name: str, seed: int) -> OnPolicyRunner:
    torch.manual_seed(seed)
    critic = RslRlMlpModelCfg(hidden_dims=[16], obs_normalization=True)
    return OnPolicyRunner(SteerToDot(8), runner_cfg(critic=critic, **CHANGES[name]).to_dict(), device="cpu")


@pytest.mark.parametrize("name", CHANGES)
@one_thread()
def test_a_resumed_run_learns_on_alike(name, tmp_path):
    """Both begin new episodes, with the same noise: weights, optimizer, normalizer and memory must be the same."""
    runner, resumed = make_runner(name, seed=0), make_runner(name, seed=1)
    runner.learn(3)
    runner.save(str(tmp_path / "model_2.pt"))
    resumed.load(str(tmp_path / "model_2.pt"))
    for each in (runner, resumed):
        each.env = SteerToDot(8, seed=5)
        each.alg.get_policy().reset()
        torch.manual_seed(5)
        each.learn(2)
        assert each.completed_iterations == 5
    for model in ("actor", "critic"):
        there, here = (getattr(each.alg, model).state_dict() for each in (runner, resumed))
        assert there.keys() == here.keys()
        assert all(torch.equal(value, here[key]) for key, value in there.items())
    assert any("normalizer" in key for key in here)
