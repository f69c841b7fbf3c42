# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Relatives of PPO: small, with memory, with rules on actions, limits on costs or bounded means, and A2C."""

from __future__ import annotations

from arcgym.rl import (
    CnnCfg,
    GaussianDistributionCfg,
    RslRlCnnModelCfg,
    RslRlMlpModelCfg,
    RslRlPpoAlgorithmCfg,
)
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.rl.agent_cfgs.image_models import RecurrentCnnModelCfg
from arcgym.rl.agent_cfgs.ppo_bounded import RslRlPpoBoundedAlgorithmCfg
from arcgym.rl.agent_cfgs.ppo_lagrangian import RslRlPpoLagrangianAlgorithmCfg, RslRlPpoLagrangianRunnerCfg
from arcgym.rl.agent_cfgs.ppo_masked import RslRlConstrainedRunnerCfg
from arcgym.rl.agent_cfgs.ppo_predicting import RslRlPpoPredictingAlgorithmCfg
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.agents.rsl_rl_cfg import PPO_SETTINGS, NavigationPPORunnerCfg


@configclass
class NavigationRecurrentPPORunnerCfg(NavigationPPORunnerCfg):
    """PPO with an LSTM behind the CNN.

    It also sees the frame stack of the task; ``env.observations.policy.rgb.history_length=1`` leaves the past to the
    memory alone. Mini-batches are of whole worlds, so that there must be twice as many worlds as mini-batches.
    """

    actor: RslRlMlpModelCfg = RecurrentCnnModelCfg(
        hidden_dims=[256], cnn_cfg=CnnCfg(), distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )


@configclass
class NavigationSmallPPORunnerCfg(NavigationPPORunnerCfg):
    """PPO with a small network for images of 40 to 48 px and a dozen worlds: learns on a CPU (docs/quickstart.md)."""

    num_steps_per_env: int = 32
    max_iterations: int = 4000
    save_interval: int = 50
    final_learning_rate: float | None = 5.0e-5
    actor: RslRlMlpModelCfg = RslRlCnnModelCfg(
        hidden_dims=[128],
        cnn_cfg=CnnCfg(output_channels=[16, 32], kernel_size=[5, 3], stride=[3, 2]),
        distribution_cfg=GaussianDistributionCfg(init_std=0.6),
    )
    critic: RslRlMlpModelCfg = RslRlMlpModelCfg(hidden_dims=[128, 64], obs_normalization=True)
    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoAlgorithmCfg(
        num_learning_epochs=4,
        num_mini_batches=4,
        learning_rate=5.0e-4,
        schedule="fixed",
        gamma=0.97,
        lam=0.95,
        clip_param=0.2,
        entropy_coef=0.003,
        max_grad_norm=0.5,
    )


@configclass
class NavigationMaskedPPORunnerCfg(NavigationPPORunnerCfg, RslRlConstrainedRunnerCfg):
    """PPO whose actions obey the paper's rules on simulated depth, in training and in evaluation.

    Report it also with ``agent.action_constraint.in_evaluation=false``: with the rules on, the policy is not one of
    color images alone.
    """

    class_name: str = "arcgym.rl.constrained_runner:ConstrainedRunner"


@configclass
class NavigationLagrangianPPORunnerCfg(NavigationPPORunnerCfg, RslRlPpoLagrangianRunnerCfg):
    """PPO under limits on the seconds of an episode in which the tip presses unsafely or sees nothing but wall."""

    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoLagrangianAlgorithmCfg(
        limits={"tip_force": 0.5, "view_blocked": 1.0}, **PPO_SETTINGS
    )


@configclass
class NavigationPredictingPPORunnerCfg(NavigationPPORunnerCfg):
    """PPO whose features also learn to predict what its critic sees: lumen, centerline ahead, forces."""

    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoPredictingAlgorithmCfg(**PPO_SETTINGS)


@configclass
class NavigationBoundedPPORunnerCfg(NavigationPPORunnerCfg):
    """PPO whose mean actions stay within [-1, 1]: for long trainings, and to go on from a policy that has left them."""

    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoBoundedAlgorithmCfg(**PPO_SETTINGS)


@configclass
class NavigationA2CRunnerCfg(NavigationPPORunnerCfg):
    """A2C with five steps a rollout, as in the paper's code, and the discount of the other agents.

    Raw actions are cut at 1: the mean drifted far beyond what the action terms carry out, at no loss but the penalty on
    changes of the raw action, which then was hundreds of times the reward. Adam and scaled advantages in place of the
    original's RMSprop, whose first steps are ten times as long as its rate: within four of them the policy drove out of
    the anus and stayed with that.
    """

    num_steps_per_env: int = 5
    clip_actions: float | None = 1.0
    max_iterations: int = 2500
    save_interval: int = 100
    algorithm: RslRlPpoAlgorithmCfg = RslRlA2cAlgorithmCfg(
        gamma=0.97, entropy_coef=0.003, optimizer="adam", normalize_advantage_per_mini_batch=True
    )
