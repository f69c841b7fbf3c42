# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The robot's scripted expert as a policy: its commands, given as the task's actions."""

from __future__ import annotations

from typing import Any

import torch

from arcgym.envs.mdp.segments import is_withdrawal
from arcgym.experts import make_expert

WITHDRAWAL_SPEED = -0.01
"""Speed of the experts on the way back [m/s]: three minutes for the colon."""


class ExpertPolicy:
    """Asks the expert for its commands and returns the actions that come closest to them.

    Actions are bounded, commands are not: an expert that bends faster than the task's action can is slowed down. It
    sees the centerline, so that its observations are not looked at.
    """

    def __init__(self, env: Any, **settings: Any) -> None:
        """Make the expert that ``EndoscopeCfg.expert`` names.

        Args:
            env: Environment, or a wrapper of it.
            settings: Arguments of the expert, such as ``speed`` [m/s].

        Raises:
            ValueError: If the robot has none.
        """
        self._env = env.unwrapped
        if is_withdrawal(self._env):
            settings.setdefault("speed", WITHDRAWAL_SPEED)
        self.expert = make_expert(self._env.scene, **settings)
        self.expert.random = self._env.random

    @torch.inference_mode(False)
    @torch.no_grad()
    def __call__(self, obs: Any = None) -> torch.Tensor:
        """Return raw actions, shape (N, A), for the scene as it is now."""
        self.expert.act()
        return self._env.action_manager.commanded_actions()

    @torch.inference_mode(False)
    @torch.no_grad()
    def reset(self, dones: torch.Tensor) -> None:
        """Let the expert forget the past of the worlds that are done, bool or int, shape (N,)."""
        env_ids = dones.nonzero().flatten()
        if len(env_ids):
            self.expert.reset(env_ids)
