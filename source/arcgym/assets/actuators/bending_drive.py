# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drive of the bending section."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import newton
import numpy as np
import torch
import warp as wp

from arcgym.assets.actuators import bending_drive_kernels as kernels
from arcgym.assets.actuators.actuator_base import ActuatorBase
from arcgym.assets.actuators.bending_drive_cfg import BendingDriveCfg
from arcgym.utils.warp_setup import WORLD_BLOCK

if TYPE_CHECKING:
    from arcgym.assets.endoscope import Endoscope


class BendingDrive(ActuatorBase):
    """Turns two control wheels, pitch and yaw, and spreads their angles over the hinges of the bending section."""

    cfg: BendingDriveCfg
    loads_links = False

    def __init__(self, cfg: BendingDriveCfg, endoscope: Endoscope):
        """Check that the stage has a bending section.

        Raises:
            ValueError: If it has none.
        """
        super().__init__(cfg, endoscope)
        self._links = endoscope.stage.bending_links
        if self._links == 0:
            raise ValueError(
                f"BendingDriveCfg needs a bending section, and {endoscope.path.name} has none: "
                "set EndoscopeSpec.bending_links (arcgym:bendingLinks in the stage) above 0."
            )

    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        """Make command and angle."""
        self._num_envs, self._device = num_envs, device
        self._coords = model.joint_coord_count // num_envs
        stage = self.endoscope.stage
        coords = stage.bend_coords[-self._links :]
        self._hinge_coords = wp.array(coords.astype(np.int32), dtype=wp.vec2i, device=device)
        self._limit = wp.vec2(*stage.hinge_limit[-self._links :].sum(axis=0))
        self.command = wp.zeros(num_envs, dtype=wp.vec2, device=device)
        """Commanded pitch and yaw [rad], shape (W,)."""
        self.angle = wp.zeros(num_envs, dtype=wp.vec2, device=device)
        """Pitch and yaw that the section is driven to [rad], shape (W,)."""
        self.commands, self.memory, self.readings = [self.command], {"angle": self.angle}, {"bending": self.angle}
        self._by_cables = self.cfg.play > 0.0 or self.cfg.lag > 0.0
        if self._by_cables:
            self._slack, self._behind = (wp.zeros(num_envs, dtype=wp.vec2, device=device) for _ in range(2))
            self.memory |= {"play": self._slack, "lag": self._behind}

    def set_command(self, pitch: torch.Tensor, yaw: torch.Tensor) -> None:
        """Set the angles of the bending section, approached at ``cfg.rate`` and within the stage's limits.

        Args:
            pitch: Bending about the tip's X axis [rad], shape (N,).
            yaw: Bending about the tip's Y axis [rad], shape (N,).
        """
        command = wp.to_torch(self.command)
        command[:, 0] = pitch
        command[:, 1] = yaw

    def apply(self, state: newton.State, control: newton.Control, resistance: wp.array, dt: float) -> None:
        """Turn the wheels towards the command and set the targets of the hinges."""
        inputs = [self.command, self.cfg.rate, self._limit, dt, self._hinge_coords, self._coords]
        outputs = [self.angle, control.joint_target_q]
        kernel = kernels.drive_bending
        if self._by_cables:
            kernel = kernels.drive_bending_by_cables
            inputs += [self.cfg.play, 1.0 if self.cfg.lag == 0.0 else 1.0 - math.exp(-dt / self.cfg.lag)]
            outputs = [self.angle, self._slack, self._behind, control.joint_target_q]
        count, device = self._num_envs, self._device
        wp.launch(kernel, count, inputs=inputs, outputs=outputs, device=device, block_dim=WORLD_BLOCK)

    def turn_tip(self, angle: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | slice) -> None:
        """Turn the wheels by the first two angles [rad], at once, and the section with them."""
        wp.to_torch(self.angle)[env_ids] += angle[:, :2]
        self._command_wheels(env_ids)

    def reset(self, env_ids: torch.Tensor) -> None:
        """Command the angles that are there."""
        self._command_wheels(env_ids)

    def _command_wheels(self, env_ids: Sequence[int] | torch.Tensor | slice) -> None:
        """Command the wheels to stay where they are."""
        wheels = wp.to_torch(self.angle)[env_ids]
        if self._by_cables:
            wheels = wheels + wp.to_torch(self._behind)[env_ids] + wp.to_torch(self._slack)[env_ids]
        wp.to_torch(self.command)[env_ids] = wheels
