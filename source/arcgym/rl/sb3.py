# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Adapter from a manager-based environment to Stable-Baselines3's ``VecEnv``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from arcgym.envs.numpy_vector_env import NumpyVectorEnv


class Sb3VecEnv(VecEnv):
    """Shows an environment to Stable-Baselines3, in NumPy arrays on the host.

    Images stay uint8 with channels first, as ``CnnPolicy`` takes them. Actions are declared bounded, because SAC and
    TD3 scale by the bounds. SB3 loops over one info a world, which is slow for hundreds of worlds: rsl_rl and skrl keep
    everything on the device.
    """

    def __init__(self, env: Any, group: str | Sequence[str] = "policy", action_bound: float = 1.0) -> None:
        """Wrap ``env``, which starts to compute final observations.

        Args:
            env: Manager-based RL environment, possibly inside Gymnasium's vector wrappers.
            group: Observation group for the policy; several names give a dict, for ``MultiInputPolicy``.
            action_bound: Largest magnitude of an action; the shipped action terms clip at 1.

        Raises:
            KeyError: If there is no such group.
            ValueError: If the environment leaves resets to the caller.
        """
        base: Any = env.unwrapped
        if base.metadata["autoreset_mode"] is not AutoresetMode.SAME_STEP:
            raise ValueError("Stable-Baselines3 needs worlds that reset by themselves: leave env.autoreset at True.")
        self.env: Any = NumpyVectorEnv(env)
        self.groups = [group] if isinstance(group, str) else list(group)
        self._is_single = isinstance(group, str)
        spaces = {name: _group_space(base.single_observation_space, name) for name in self.groups}
        observations = spaces[self.groups[0]] if self._is_single else gym.spaces.Dict(spaces)
        actions = gym.spaces.Box(-action_bound, action_bound, base.single_action_space.shape, np.float32)
        super().__init__(base.num_envs, observations, actions)
        self._actions: np.ndarray | None = None

    def reset(self) -> Any:
        """Start new episodes in all worlds, with the seed set by :meth:`seed`, and return their observations."""
        obs, _ = self.env.reset(seed=self._seeds[0])
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        self._reset_seeds()
        return self._choose(obs)

    def step_async(self, actions: np.ndarray) -> None:
        """Take the actions of the next step, shape (N, A)."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Step all worlds and return observations, rewards, dones and one info a world.

        A world that is done has ``terminal_observation``, its last one before the reset, and ``TimeLimit.truncated``,
        whether its value goes on: False for time-outs of tasks whose horizon is finite.
        """
        obs, rewards, terminated, truncated, infos = self.env.step(self._actions)
        done = terminated | truncated
        is_bootstrapped = truncated & ~terminated & (not self.env.unwrapped.cfg.is_finite_horizon)
        entries: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for world in np.flatnonzero(done):
            last = infos["final_obs"][world]
            entries[world]["terminal_observation"] = self._choose(last)
            entries[world]["TimeLimit.truncated"] = bool(is_bootstrapped[world])
            entries[world]["is_success"] = bool(infos["final_info"]["success"][world])
        return self._choose(obs), rewards, done, entries

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Return a picture of every world."""
        return self.env.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, once for each chosen world: they share it."""
        return [getattr(self.env.unwrapped, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the environment, which all worlds share."""
        setattr(self.env.unwrapped, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Call a method of the environment once and return its result for each chosen world."""
        result = getattr(self.env.unwrapped, method_name)(*args, **kwargs)
        return [result] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Return that no world has a wrapper of its own."""
        return [False] * len(list(self._get_indices(indices)))

    def _choose(self, obs: dict[str, Any]) -> Any:
        return obs[self.groups[0]] if self._is_single else {name: obs[name] for name in self.groups}


def _group_space(space: gym.spaces.Dict, name: str) -> gym.Space:
    if name not in space.spaces:
        raise KeyError(f"There is no observation group '{name}'. Available: {', '.join(space.spaces)}.")
    return space[name]
