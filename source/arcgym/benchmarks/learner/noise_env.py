# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An environment of noise with the shapes of a navigation task, which costs hardly any time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict


class NoiseEnv(VecEnv):
    """N worlds with random images that stack like a task's, random states and random rewards."""

    def __init__(
        self, num_envs: int, size: int, frames: int, num_states: int, num_actions: int, costs: list[str], device: str
    ):
        """Draw the images once.

        Args:
            num_envs: Number of worlds N.
            size: Edge of the square images [px].
            frames: RGB images in a stack.
            num_states: Width of the group ``critic``.
            num_actions: Width of the action.
            costs: Names of the costs.
            device: Where everything is.
        """
        self.num_envs, self.num_actions, self.device, self.max_episode_length = num_envs, num_actions, device, 100
        self.cfg: Any = SimpleNamespace(compute_final_obs=False, is_finite_horizon=False)
        self.unwrapped = self
        self.common_step_counter = 0
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long, device=device)
        self._costs, self._frames, self._num_states = costs, frames, num_states
        shape = (frames + 16, num_envs, 3, size, size)
        self._film = torch.randint(0, 256, shape, dtype=torch.uint8, device=device)

    def get_observations(self) -> TensorDict:
        """Return the next stack of the film, shape (N, 3 × frames, H, W), and states."""
        numbers = torch.arange(self._frames, device=self.device) + self.common_step_counter
        stack = self._film[numbers % len(self._film)].transpose(0, 1).flatten(1, 2)
        states = torch.randn(self.num_envs, self._num_states, device=self.device)
        return TensorDict({"policy": stack, "critic": states}, batch_size=[self.num_envs], device=self.device)

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict]:
        """Return noise; no episode ends."""
        self.common_step_counter += 1
        zeros = torch.zeros(self.num_envs, device=self.device)
        extras = {"time_outs": zeros.bool(), "costs": {name: zeros for name in self._costs}, "log": {}}
        return self.get_observations(), torch.rand_like(zeros), zeros.long(), extras
