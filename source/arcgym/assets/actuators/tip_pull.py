# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pull on the tip, as by a magnet outside the body."""

from __future__ import annotations

from collections.abc import Sequence

import newton
import torch
import warp as wp

from arcgym.assets.actuators import tip_pull_kernels as kernels
from arcgym.assets.actuators.actuator_base import ActuatorBase
from arcgym.assets.actuators.tip_pull_cfg import TipPullCfg


class TipPull(ActuatorBase):
    """Pulls the last link after a target that moves at the commanded velocity."""

    cfg: TipPullCfg

    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        """Make commands, the target's lead and averages."""
        self._num_envs, self._device = num_envs, device
        self._spring = kernels.TipSpring()
        for name in ("stiffness", "damping", "force_limit", "angular_stiffness", "angular_damping", "torque_limit"):
            setattr(self._spring, name, getattr(self.cfg, name))
        self.linear, self.angular, self.lead, self.turn, self.force = (
            wp.zeros(num_envs, dtype=wp.vec3, device=device) for _ in range(5)
        )
        self._now = wp.zeros(num_envs, dtype=wp.vec4, device=device)
        self._still = wp.zeros((1, num_envs), dtype=wp.vec3, device=device)
        self.commands, self.averages = [self.linear, self.angular], [self.force]
        self.memory = {"lead": self.lead, "turn": self.turn}
        self.readings = {"tip_pull_force_w": self.force}

    def set_command(self, lin_vel: torch.Tensor, ang_vel: torch.Tensor) -> None:
        """Set the velocity for the tip to follow, in its own frame (+Z forward, +Y up), kept until changed.

        Args:
            lin_vel: Linear velocity [m/s], shape (N, 3).
            ang_vel: Angular velocity [rad/s], shape (N, 3).
        """
        wp.to_torch(self.linear).copy_(lin_vel)
        wp.to_torch(self.angular).copy_(ang_vel)

    def apply(self, state: newton.State, control: newton.Control, resistance: wp.array, dt: float) -> None:
        """Move the target on and pull."""
        inputs = [state.body_q, state.body_qd, self._spring, self.linear, self.angular, dt]
        outputs = [self.lead, self.turn, state.body_f, resistance, self._now]
        wp.launch(kernels.pull_tip, self._num_envs, inputs=inputs, outputs=outputs, device=self._device)

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        """Add the pull at the end of the substep."""
        inputs = [self._now, acceleration, weight]
        wp.launch(kernels.record_pull, self._num_envs, inputs=inputs, outputs=[self.force], device=self._device)

    def record_explicit(self, state: newton.State, control: newton.Control, weight: float) -> None:
        """Add the pull at the start of the substep."""
        self.record(None, self._still, weight)

    def turn_tip(self, angle: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | slice) -> None:
        """Turn the target by rotation vectors in world axes [rad]."""
        wp.to_torch(self.turn)[env_ids] += angle
