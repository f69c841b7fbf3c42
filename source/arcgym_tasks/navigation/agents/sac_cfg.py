# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Soft actor-critic for the navigation tasks."""

from __future__ import annotations

from typing import Any

from arcgym.rl import CnnCfg, RslRlMlpModelCfg
from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg
from arcgym.rl.agent_cfgs.sac import (
    RslRlDistributionalSacAlgorithmCfg,
    RslRlSacAlgorithmCfg,
    RslRlSacRunnerCfg,
    SquashedGaussianDistributionCfg,
)
from arcgym.utils.configclass import configclass


@configclass
class NavigationSACRunnerCfg(RslRlSacRunnerCfg):
    """SAC for many worlds, with critics on the privileged state and shifted images for the actor.

    A step's rewards differ by a few tenths, so that the temperature starts at 0.01: at 0.1 entropy outweighs them, the
    policy stays near uniform, and the temperature takes tens of thousands of gradient steps to fall.
    The memory takes 8.5 GB; lower ``agent.algorithm.replay_size`` or the camera's size where that is too much.
    """

    max_iterations: int = 1500
    save_interval: int = 100
    experiment_name: str = "arc_navigation"
    algorithm: Any = RslRlSacAlgorithmCfg(
        frame_stacks={"policy": 5}, updates_per_transition=0.125, num_steps=3, init_temperature=0.01
    )


@configclass
class SquintSACRunnerCfg(NavigationSACRunnerCfg):
    """SAC with categorical critics and a memory of a million observations, as Squint has for a thousand worlds.

    Squint draws at 128 px and learns at 16 px with changed colors; here the camera's 84 px become 21 px, of which the
    memory takes 1.3 GB.
    """

    actor: RslRlMlpModelCfg = AugmentedCnnModelCfg(
        hidden_dims=[256],
        activation="relu",
        cnn_cfg=CnnCfg(output_channels=[32, 64, 64], kernel_size=3, stride=[2, 1, 1], activation="relu"),
        shrink=4,
        shift=1,
        color_jitter=0.2,
        distribution_cfg=SquashedGaussianDistributionCfg(),  # type: ignore[arg-type]
    )
    algorithm: Any = RslRlDistributionalSacAlgorithmCfg(
        frame_stacks={"policy": 5}, replay_size=1_000_000, num_steps=3, init_temperature=0.01
    )


@configclass
class PaperSACRunnerCfg(NavigationSACRunnerCfg):
    """The paper's setting, five worlds and a memory of 10 000 transitions: one gradient step for 25 transitions.

    What the paper's code has: fixed temperature 0.5, learning starts when the memory is full, two gradient steps after
    ten control steps of five worlds. Network and critics are the project's.
    """

    num_steps_per_env: int = 10
    algorithm: Any = RslRlSacAlgorithmCfg(
        frame_stacks={"policy": 5},
        replay_size=12_000,
        learning_starts=10_000,
        updates_per_transition=0.04,
        batch_size=256,
        actor_interval=1,
        target_step=0.005,
        gamma=0.99,
        init_temperature=0.5,
        learn_temperature=False,
    )
