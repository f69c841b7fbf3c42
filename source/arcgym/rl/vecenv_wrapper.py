# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Adapter from a manager-based environment to rsl_rl's ``VecEnv``."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import torch
from gymnasium.vector import AutoresetMode
from rsl_rl.env import VecEnv
from tensordict import TensorDict

MEANS = ("Episode_Metrics/", "Episode_Reward/", "Episode_Cost/")
"""Beginnings of the names in the log whose values are means over the worlds that end in a step."""


class RslRlVecEnvWrapper(VecEnv):
    """Shows a manager-based environment to rsl_rl.

    It resets the environment once, because rsl_rl's runner never does. Observations are handed on as they are: rsl_rl
    keeps a reference to them across :meth:`step`, and the environment writes each step's into new memory.
    """

    def __init__(self, env: gym.Env, clip_actions: float | None = None):
        """Wrap and reset ``env``.

        Args:
            env: Manager-based RL environment, possibly inside Gymnasium wrappers.
            clip_actions: Bound on the magnitude of raw actions, or None.

        Raises:
            ValueError: If the environment leaves resets to the caller.
        """
        if env.unwrapped.metadata.get("autoreset_mode") is AutoresetMode.DISABLED:
            raise ValueError("rsl_rl needs an environment that resets worlds by itself: leave env.autoreset at True.")
        self.env: Any = env
        self.clip_actions = clip_actions
        self.num_envs = self.unwrapped.num_envs
        self.device = self.unwrapped.device
        self.max_episode_length = self.unwrapped.max_episode_length
        self.num_actions = self.unwrapped.action_manager.total_action_dim
        self._obs = self.pack(env.reset()[0])

    @property
    def unwrapped(self) -> Any:
        """The environment itself, without Gymnasium's wrappers."""
        return self.env.unwrapped

    @property
    def cfg(self) -> object:
        """Configuration of the environment."""
        return self.unwrapped.cfg

    @property
    def episode_length_buf(self) -> torch.Tensor:
        """Control steps since each world's reset, shape (N,), int64."""
        return self.unwrapped.episode_length_buf

    @episode_length_buf.setter
    def episode_length_buf(self, value: torch.Tensor) -> None:
        self.unwrapped.episode_length_buf = value

    def get_observations(self) -> TensorDict:
        """Return the latest observations without computing them again, which would advance their histories."""
        return self._obs

    def reset(self, seed: int | None = None) -> tuple[TensorDict, dict]:
        """Reset every world, after setting the seed if one is given, and return observations and extras."""
        obs, extras = self.env.reset(seed=seed)
        self._obs = self.pack(obs)
        return self._obs, extras

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict]:
        """Apply raw actions of shape (N, A) for one control step.

        Returns:
            Observations, rewards (N,), dones (N,) int64, and extras. ``extras["time_outs"]``, which makes rsl_rl add
            the value of the state after a truncation, is false in a world that also terminated, and is left out when
            the task's horizon is finite. Means over the worlds that end are in ``extras["log"]`` once for each of
            them, as rsl_rl takes the mean of a rollout's values: so it is that of its episodes.
        """
        if self.clip_actions is not None:
            actions = actions.clamp(-self.clip_actions, self.clip_actions)
        obs, rewards, terminated, truncated, extras = self.env.step(actions)
        self._obs = self.pack(obs)
        extras = {key: value for key, value in extras.items() if key != "time_outs"}
        extras["log"] = {name: self._once_an_episode(name, value) for name, value in extras["log"].items()}
        if not self.unwrapped.cfg.is_finite_horizon:
            extras["time_outs"] = truncated & ~terminated
        return self._obs, rewards.clone(), (terminated | truncated).long(), extras

    def _once_an_episode(self, name: str, value: Any) -> Any:
        """Return a mean over the worlds that ended, shape (), as often as there were such; other values as they are."""
        is_mean = name.startswith(MEANS) and isinstance(value, torch.Tensor) and value.dim() == 0
        return value.expand(self.unwrapped.num_done) if is_mean else value

    def seed(self, seed: int) -> int:
        """Seed the environment."""
        return self.unwrapped.seed(seed)

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def pack(self, obs: dict[str, torch.Tensor]) -> TensorDict:
        """Return an environment's observation groups, each of shape (N, ...), as rsl_rl's models read them.

        Raises:
            TypeError: If a group is not one tensor.
        """
        nested = [name for name, value in obs.items() if not isinstance(value, torch.Tensor)]
        if nested:
            raise TypeError(
                f"Observation group '{nested[0]}' is a {type(obs[nested[0]]).__name__}, expected one tensor; rsl_rl "
                "reads whole groups. Set concatenate_terms=True on it or split it into groups."
            )
        return TensorDict(dict(obs), batch_size=[self.num_envs], device=self.device)
