# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Two tiny vectorised tasks with images: steer to a bright dot, and remember on which side a light was."""

from __future__ import annotations

import math
from types import SimpleNamespace

import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict

SIZE = 16


class PixelTask(VecEnv):
    """Episodes of a fixed number of steps in N worlds; subclasses say what is seen, done and earned."""

    num_actions = 1
    episode_steps = 8

    def __init__(self, num_envs: int = 64, seed: int = 0, finite_horizon: bool = False):
        self.num_envs, self.device = num_envs, "cpu"
        self.max_episode_length = self.episode_steps
        self.cfg = SimpleNamespace(is_finite_horizon=finite_horizon, compute_final_obs=True)
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long)
        self.common_step_counter = 0
        self.random = torch.Generator().manual_seed(seed)
        self.start(torch.ones(num_envs, dtype=torch.bool))

    @property
    def unwrapped(self) -> PixelTask:
        return self

    def start(self, worlds: torch.Tensor) -> None:
        raise NotImplementedError

    def move(self, actions: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Move and return reward and cost."""
        raise NotImplementedError

    def observe(self) -> dict[str, torch.Tensor]:
        raise NotImplementedError

    def terminated(self) -> torch.Tensor:
        return torch.zeros(self.num_envs, dtype=torch.bool)

    def get_observations(self) -> TensorDict:
        return TensorDict(self.observe(), batch_size=[self.num_envs])

    def step(self, actions):
        self.common_step_counter += 1
        self.episode_length_buf += 1
        reward, cost = self.move(actions)
        terminated = self.terminated()
        truncated = (self.episode_length_buf >= self.episode_steps) & ~terminated
        done = terminated | truncated
        extras = {"log": {}, "cost": cost, "costs": {"effort": cost}}
        if not self.cfg.is_finite_horizon:
            extras["time_outs"] = truncated
        if self.cfg.compute_final_obs and bool(done.any()):
            extras["final_obs"] = self.observe()
        self.episode_length_buf[done] = 0
        self.start(done)
        return self.get_observations(), reward, done.long(), extras


class SteerToDot(PixelTask):
    """A dot at an offset from the image center; actions move it by up to a quarter of the half image a step.

    Reward is one minus the distance. A policy that sees nothing earns less than 0.4 a step, the best one more than 0.8.
    """

    num_actions = 2

    def start(self, worlds):
        if not hasattr(self, "offset"):
            self.offset = torch.zeros(self.num_envs, 2)
        fresh = 2.0 * torch.rand(self.num_envs, 2, generator=self.random) - 1.0
        self.offset = torch.where(worlds[:, None], fresh, self.offset)

    def move(self, actions):
        self.offset = (self.offset + 0.25 * actions.clamp(-1.0, 1.0)).clamp(-1.0, 1.0)
        return 1.0 - self.offset.norm(dim=1), actions.square().sum(dim=1)

    def observe(self):
        grid = torch.linspace(-1.0, 1.0, SIZE)
        x, y = self.offset[:, 0, None, None], self.offset[:, 1, None, None]
        light = torch.exp(-((grid[None, None, :] - x) ** 2 + (grid[None, :, None] - y) ** 2) / 0.05)
        image = (255.0 * light).to(torch.uint8).unsqueeze(1)
        return {"policy": image, "critic": self.offset.clone()}


class RememberTheSide(PixelTask):
    """A light on the left or right at the first step, then darkness: each later step earns the action towards it.

    Without memory the mean reward is zero; the best is one in every step but the first, (T - 1) / T.
    """

    episode_steps = 5

    def start(self, worlds):
        if not hasattr(self, "side"):
            self.side = torch.ones(self.num_envs)
        fresh = torch.randint(0, 2, (self.num_envs,), generator=self.random) * 2.0 - 1.0
        self.side = torch.where(worlds, fresh, self.side)

    def move(self, actions):
        reward = self.side * actions[:, 0].clamp(-1.0, 1.0)
        return torch.where(self.episode_length_buf > 1, reward, 0.0), actions.square().sum(dim=1)

    def observe(self):
        image = torch.zeros(self.num_envs, 1, SIZE, SIZE, dtype=torch.uint8)
        lit = self.episode_length_buf == 0
        image[lit & (self.side < 0), :, :, : SIZE // 2] = 255
        image[lit & (self.side > 0), :, :, SIZE // 2 :] = 255
        time = self.episode_length_buf / self.episode_steps
        return {"policy": image, "critic": torch.stack((self.side, time), dim=1)}


class PayForSpeed(PixelTask):
    """One step an episode: reward is the action, cost its square; the best mean action under a limit d is sqrt(d).

    The multiplier at the optimum is 1 / (2 sqrt(d)), where the slopes of reward and cost cancel.
    """

    episode_steps = 1

    def start(self, worlds):
        pass

    def move(self, actions):
        return actions[:, 0], actions[:, 0].square()

    def observe(self):
        ones = torch.ones(self.num_envs, 1)
        return {"policy": ones, "critic": ones}

    def terminated(self):
        return torch.ones(self.num_envs, dtype=torch.bool)


def mean_reward(env: PixelTask, policy, steps: int) -> float:
    """Return the mean reward of a step under a policy, whose memory is cleared at episode ends."""
    total, obs = 0.0, env.get_observations()
    with torch.inference_mode():
        for _ in range(steps):
            obs, reward, dones, _ = env.step(policy(obs))
            getattr(policy, "reset", lambda dones: None)(dones)
            total += float(reward.mean())
    assert math.isfinite(total)
    return total / steps
