# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Agent configurations for the pixel tasks: one small encoder, a privileged critic."""

from __future__ import annotations

import torch

from arcgym.rl import (
    CnnCfg,
    GaussianDistributionCfg,
    OnPolicyRunner,
    RslRlCnnModelCfg,
    RslRlMlpModelCfg,
    RslRlOnPolicyRunnerCfg,
    RslRlPpoAlgorithmCfg,
)
from arcgym.rl.agent_cfgs.image_models import RecurrentCnnModelCfg

ENCODER = CnnCfg(output_channels=[8, 8], kernel_size=[4, 3], stride=[2, 2], activation="relu")


def actor_cfg() -> RslRlCnnModelCfg:
    return RslRlCnnModelCfg(hidden_dims=[32], cnn_cfg=ENCODER, distribution_cfg=GaussianDistributionCfg(init_std=0.6))


def with_memory(**changes) -> RecurrentCnnModelCfg:
    """The actor of :func:`actor_cfg` with a GRU of four numbers beside its features."""
    settings = {"skip_connection": True, "rnn_type": "gru", "rnn_hidden_dim": 4, "hidden_dims": [32]}
    deviation = GaussianDistributionCfg(init_std=0.6)
    return RecurrentCnnModelCfg(cnn_cfg=ENCODER, distribution_cfg=deviation, **(settings | changes))


def runner_cfg(**changes) -> RslRlOnPolicyRunnerCfg:
    settings = {
        "num_steps_per_env": 8,
        "actor": actor_cfg(),
        "critic": RslRlMlpModelCfg(hidden_dims=[32]),
        "algorithm": RslRlPpoAlgorithmCfg(learning_rate=3e-3, schedule="fixed", gamma=0.8, entropy_coef=0.0),
        "init_at_random_ep_len": False,
    }
    return RslRlOnPolicyRunnerCfg(**(settings | changes))


def roll_and_update(runner: OnPolicyRunner) -> dict[str, float]:
    """Collect one rollout of eight steps and return the losses of the update."""
    obs = runner.env.get_observations()
    with torch.inference_mode():
        for _ in range(8):
            obs, rewards, dones, extras = runner.env.step(runner.alg.act(obs))
            runner.alg.process_env_step(obs, rewards, dones, extras)
        runner.alg.compute_returns(obs)
    return runner.alg.update()
