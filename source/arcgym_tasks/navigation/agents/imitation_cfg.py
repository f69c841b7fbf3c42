# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning from a teacher or from recorded episodes, for the navigation tasks."""

from __future__ import annotations

from typing import Any

from arcgym.rl import CnnCfg, GaussianDistributionCfg, RslRlCnnModelCfg, RslRlMlpModelCfg, RslRlPpoAlgorithmCfg
from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg, RecurrentCnnModelCfg
from arcgym.rl.agent_cfgs.imitation import (
    RslRlBehaviorCloningAlgorithmCfg,
    RslRlBehaviorCloningRunnerCfg,
    RslRlDistillationAlgorithmCfg,
    RslRlDistillationRunnerCfg,
)
from arcgym.rl.agent_cfgs.ppo_taught import RslRlPpoTaughtAlgorithmCfg, RslRlTaughtRunnerCfg
from arcgym.utils.configclass import configclass
from arcgym_tasks.navigation.agents.ppo_variants_cfg import NavigationBoundedPPORunnerCfg
from arcgym_tasks.navigation.agents.rsl_rl_cfg import PPO_SETTINGS, NavigationPPORunnerCfg

_LEAKY = GaussianDistributionCfg(class_name="arcgym.rl.networks.leaky_gaussian:LeakyGaussianDistribution", init_std=0.6)


@configclass
class NavigationTeacherRunnerCfg(NavigationPPORunnerCfg):
    """PPO whose policy sees the privileged state: a teacher for distillation, and a bound on what images can do."""

    obs_groups: dict[str, list[str]] = {"actor": ["critic"], "critic": ["critic"]}
    actor: RslRlMlpModelCfg = RslRlMlpModelCfg(
        hidden_dims=[256, 128], obs_normalization=True, distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )


@configclass
class NavigationRgbTeacherRunnerCfg(NavigationBoundedPPORunnerCfg):
    """PPO whose policy sees the privileged state beside the images: ``agent.init_policy`` may be a policy of images.

    It begins as that one and learns to use the state, so that it shows what its images did not tell it. The leaky
    distribution fits policies of the plain one, too.
    """

    obs_groups: dict[str, list[str]] = {"actor": ["policy", "critic"], "critic": ["critic"]}
    actor: RslRlMlpModelCfg = RslRlCnnModelCfg(hidden_dims=[256], obs_normalization=True, distribution_cfg=_LEAKY)


@configclass
class NavigationDistillationRunnerCfg(RslRlDistillationRunnerCfg):
    """From ``ppo_teacher`` to images: ``agent.teacher_checkpoint=logs/rsl_rl/.../model_499.pt``."""

    num_steps_per_env: int = 24
    max_iterations: int = 300
    save_interval: int = 25
    experiment_name: str = "arc_navigation"
    student: RslRlMlpModelCfg = AugmentedCnnModelCfg(
        hidden_dims=[256], distribution_cfg=GaussianDistributionCfg(init_std=0.1)
    )
    teacher: RslRlMlpModelCfg = RslRlMlpModelCfg(
        hidden_dims=[256, 128], obs_normalization=True, distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )


@configclass
class RecurrentDistillationRunnerCfg(NavigationDistillationRunnerCfg):
    """The same with a memory beside the features of the images, for what the teacher sees and one moment does not show.

    ``agent.init_policy`` may be a policy without memory. The memory learns over ``gradient_length`` steps.
    """

    student: RslRlMlpModelCfg = RecurrentCnnModelCfg(
        hidden_dims=[256],
        cnn_cfg=CnnCfg(),
        distribution_cfg=GaussianDistributionCfg(init_std=0.1),
        rnn_type="gru",
        skip_connection=True,
    )
    algorithm: Any = RslRlDistillationAlgorithmCfg(gradient_length=24)


@configclass
class RgbDistillationRunnerCfg(RecurrentDistillationRunnerCfg):
    """The same from ``ppo_teacher_rgb``, whose images the student sees as well."""

    obs_groups: dict[str, list[str]] = {"student": ["policy"], "teacher": ["policy", "critic"]}
    student: RslRlMlpModelCfg = RecurrentCnnModelCfg(
        hidden_dims=[256],
        cnn_cfg=CnnCfg(),
        distribution_cfg=GaussianDistributionCfg(class_name=_LEAKY.class_name, init_std=0.1),
        rnn_type="gru",
        skip_connection=True,
    )
    teacher: RslRlMlpModelCfg = NavigationRgbTeacherRunnerCfg().actor


@configclass
class NavigationTaughtPPORunnerCfg(NavigationPPORunnerCfg, RslRlTaughtRunnerCfg):
    """PPO from images with a memory, which ``ppo_teacher_rgb`` tells what it would do, less and less.

    ``agent.teacher_checkpoint=...``, and ``agent.init_policy=...`` with a student of ``distillation_rgb``. Rollouts are
    longer than PPO's, as the memory learns over them.
    """

    class_name: str = "arcgym.rl.taught_runner:TaughtRunner"
    num_steps_per_env: int = 24
    obs_groups: dict[str, list[str]] = {"actor": ["policy"], "critic": ["critic"], "teacher": ["policy", "critic"]}
    actor: RslRlMlpModelCfg = RgbDistillationRunnerCfg().student
    teacher: RslRlMlpModelCfg = NavigationRgbTeacherRunnerCfg().actor
    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoTaughtAlgorithmCfg(**PPO_SETTINGS)


@configclass
class NavigationBehaviorCloningRunnerCfg(RslRlBehaviorCloningRunnerCfg):
    """From the scripted expert, or from recorded episodes: ``agent.algorithm.demonstrations=logs/episodes``.

    Its checkpoints start the other agents with a CNN: ``--agent ppo agent.init_policy=...``.
    """

    max_iterations: int = 200
    save_interval: int = 25
    experiment_name: str = "arc_navigation"
    actor: RslRlMlpModelCfg = AugmentedCnnModelCfg(
        hidden_dims=[256], distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )
    algorithm: Any = RslRlBehaviorCloningAlgorithmCfg(demonstrations="expert")


@configclass
class NavigationSmallBehaviorCloningRunnerCfg(NavigationBehaviorCloningRunnerCfg):
    """The same with the network of ``ppo_small``, which its checkpoints start, and fewer steps of the expert."""

    max_iterations: int = 30
    actor: RslRlMlpModelCfg = AugmentedCnnModelCfg(
        hidden_dims=[128],
        cnn_cfg=CnnCfg(output_channels=[16, 32], kernel_size=[5, 3], stride=[3, 2]),
        shift=2,
        distribution_cfg=GaussianDistributionCfg(init_std=0.6),
    )
    algorithm: Any = RslRlBehaviorCloningAlgorithmCfg(demonstrations="expert", expert_steps=3_000)
