# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings that all navigation tasks share."""

from __future__ import annotations

from typing import Any

from arcgym.rl import (
    GaussianDistributionCfg,
    RslRlCnnModelCfg,
    RslRlMlpModelCfg,
    RslRlOnPolicyRunnerCfg,
    RslRlPpoAlgorithmCfg,
)
from arcgym.utils.configclass import configclass

PPO_SETTINGS: dict[str, Any] = {
    "num_learning_epochs": 3,
    "num_mini_batches": 6,
    "learning_rate": 3.0e-4,
    "schedule": "fixed",
    "gamma": 0.97,
    "lam": 0.95,
    "clip_param": 0.2,
    "entropy_coef": 0.003,
    "max_grad_norm": 0.5,
}
"""Settings of PPO and of its relatives that learn from the same rollouts."""


@configclass
class NavigationPPORunnerCfg(RslRlOnPolicyRunnerCfg):
    """PPO from images, with a critic on the privileged state.

    Rollouts are short, because what counts is the number of updates: with 512 worlds and 12 steps the magnetic scope
    learnt to pass the sigmoid in 190 000 to 250 000 transitions, 31 to 40 updates (docs/research_log.md).
    """

    num_steps_per_env: int = 12
    max_iterations: int = 1000
    save_interval: int = 50
    experiment_name: str = "arc_navigation"
    obs_groups: dict[str, list[str]] = {"actor": ["policy"], "critic": ["critic"]}
    actor: RslRlMlpModelCfg = RslRlCnnModelCfg(
        hidden_dims=[256], distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )
    critic: RslRlMlpModelCfg = RslRlMlpModelCfg(hidden_dims=[256, 128], obs_normalization=True)
    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoAlgorithmCfg(**PPO_SETTINGS)
