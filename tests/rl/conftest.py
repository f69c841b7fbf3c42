# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A counting environment with the interface of ManagerBasedRLEnv, and small agent configurations for it."""

from __future__ import annotations

from types import SimpleNamespace

import gymnasium as gym
import pytest
import torch

from arcgym.rl import (
    CnnCfg,
    GaussianDistributionCfg,
    RslRlCnnModelCfg,
    RslRlMlpModelCfg,
    RslRlOnPolicyRunnerCfg,
    RslRlPpoAlgorithmCfg,
)


class CountingEnv(gym.Env):
    """Every byte of a world's image is the number of steps it has made; reward is the first action."""

    def __init__(self, num_envs: int = 2, episode_length: int = 4, is_finite_horizon: bool = False):
        self.num_envs, self.device, self.max_episode_length = num_envs, "cpu", episode_length
        viewer = SimpleNamespace(env_id=0)
        self.cfg = SimpleNamespace(is_finite_horizon=is_finite_horizon, autoreset=True, viewer=viewer)
        self.action_manager = SimpleNamespace(total_action_dim=2)
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long)
        self.common_step_counter = 0
        self.image = torch.zeros(num_envs, 3, 20, 20, dtype=torch.uint8)
        self.last_action: torch.Tensor | None = None

    def reset(self, seed=None, options=None):
        self.episode_length_buf.zero_()
        return self._obs(), {}

    def step(self, action):
        self.last_action = action
        self.common_step_counter += 1
        self.episode_length_buf += 1
        truncated = self.episode_length_buf >= self.max_episode_length
        self.episode_length_buf[truncated] = 0
        extras = {"log": {"Episode_Reward/first": 1.0}, "cost": torch.zeros(self.num_envs)}
        return self._obs(), action[:, 0], torch.zeros_like(truncated), truncated, extras

    def _obs(self):
        self.image = self.episode_length_buf.to(torch.uint8)[:, None, None, None].expand_as(self.image).clone()
        return {"policy": self.image, "critic": self.episode_length_buf.float()[:, None]}


@pytest.fixture
def counting_env() -> CountingEnv:
    return CountingEnv()


@pytest.fixture
def agent_cfg() -> RslRlOnPolicyRunnerCfg:
    cnn = CnnCfg(output_channels=[4, 4], kernel_size=[4, 3], stride=[2, 2])
    return RslRlOnPolicyRunnerCfg(
        num_steps_per_env=4,
        max_iterations=2,
        actor=RslRlCnnModelCfg(hidden_dims=[8], cnn_cfg=cnn, distribution_cfg=GaussianDistributionCfg(init_std=0.5)),
        critic=RslRlMlpModelCfg(hidden_dims=[8], obs_normalization=True),
        algorithm=RslRlPpoAlgorithmCfg(num_learning_epochs=1, num_mini_batches=2),
    )
