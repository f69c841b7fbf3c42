# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Expert for a scope that is pushed and bent."""

from __future__ import annotations

import torch

from arcgym.experts.expert_base import ExpertBase
from arcgym.experts.lumen_ahead import lumen_direction
from arcgym.scene.interactive_scene import InteractiveScene

LARGEST_BENDING = 2.9
"""Largest bending commanded [rad]."""


class PushExpert(ExpertBase):
    """Steers the bending section towards the centerline ahead and pushes, slower where the lumen is off to a side."""

    def __init__(self, scene: InteractiveScene, speed: float = 0.04, ahead: float = 0.04, gain: float = 0.35):
        """Keep the settings.

        Args:
            scene: The scene.
            speed: Insertion speed while the lumen is ahead [m/s].
            ahead: Distance looked ahead [m].
            gain: Share of the angle to the target by which the command changes each step.
        """
        super().__init__(scene, speed)
        self.ahead, self.gain = ahead, gain
        self.bending = torch.zeros(scene.num_envs, 2, device=scene.device)
        """Commanded pitch and yaw [rad], shape (N, 2)."""
        self.velocity = torch.zeros(scene.num_envs, device=scene.device)
        """Commanded insertion [m/s], shape (N,)."""

    def act(self) -> None:
        """Set bending and insertion commands."""
        direction = lumen_direction(self.scene, self.ahead)
        angle = torch.acos(direction[:, 2].clamp(-1.0, 1.0))
        error = torch.stack([-direction[:, 1], direction[:, 0]], dim=1)
        error = torch.nn.functional.normalize(error, dim=1) * angle[:, None]
        self.bending += self.gain * error
        norm = self.bending.norm(dim=1, keepdim=True)
        self.bending *= (LARGEST_BENDING / norm.clamp(min=1.0e-6)).clamp(max=1.0)
        pace = torch.where(angle < 0.5, 1.0, torch.where(angle < 1.0, 0.5, 0.15))
        self.velocity += (self.speed * pace - self.velocity).clamp(-0.03, 0.03)
        endoscope = self.scene["endoscope"]
        endoscope.set_bending_command(self.bending[:, 0], self.bending[:, 1])
        endoscope.set_insertion_command(self.velocity, torch.zeros_like(self.velocity))

    def reset(self, env_ids: torch.Tensor) -> None:
        """Take up the bending that some worlds start with, and stand still there."""
        self.bending[env_ids] = self.scene["endoscope"].data.bending[env_ids]
        self.velocity[env_ids] = 0.0
