# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning settings that all navigation tasks share."""

from __future__ import annotations

from arcgym.rl import (
    GaussianDistributionCfg,
    RslRlCnnModelCfg,
    RslRlMlpModelCfg,
    RslRlOnPolicyRunnerCfg,
    RslRlPpoAlgorithmCfg,
)
from arcgym.utils.configclass import configclass


@configclass
class NavigationPPORunnerCfg(RslRlOnPolicyRunnerCfg):
    """PPO from images, with a critic on the privileged state.

    With these values a tip without shaft in a rigid colon learnt to follow the lumen in 250 000 transitions.
    """

    num_steps_per_env: int = 24
    max_iterations: int = 500
    save_interval: int = 25
    experiment_name: str = "arc_navigation"
    obs_groups: dict[str, list[str]] = {"actor": ["policy"], "critic": ["critic"]}
    actor: RslRlMlpModelCfg = RslRlCnnModelCfg(
        hidden_dims=[256], distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )
    critic: RslRlMlpModelCfg = RslRlMlpModelCfg(hidden_dims=[256, 128], obs_normalization=True)
    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoAlgorithmCfg(
        num_learning_epochs=3,
        num_mini_batches=6,
        learning_rate=3.0e-4,
        schedule="fixed",
        gamma=0.97,
        lam=0.95,
        clip_param=0.2,
        entropy_coef=0.003,
        max_grad_norm=0.5,
    )
