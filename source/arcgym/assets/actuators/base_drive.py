# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drive of a shaft's base: insertion and roll."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import newton
import torch
import warp as wp

from arcgym.assets.actuators import base_drive_kernels as kernels
from arcgym.assets.actuators.actuator_base import ActuatorBase
from arcgym.assets.actuators.base_drive_cfg import BaseDriveCfg
from arcgym.utils.warp_setup import WORLD_BLOCK

if TYPE_CHECKING:
    from arcgym.assets.endoscope import Endoscope


class BaseDrive(ActuatorBase):
    """Moves the targets of slide and roll at the commanded speeds, no further ahead than the force limits reach."""

    cfg: BaseDriveCfg
    loads_links = False

    def __init__(self, cfg: BaseDriveCfg, endoscope: Endoscope):
        """Check that the stage has a driven slide.

        Raises:
            ValueError: If its slide or roll has no stiffness.
        """
        super().__init__(cfg, endoscope)
        slide, roll = endoscope.stage.slide_drive, endoscope.stage.roll_drive
        if slide is None or roll is None or slide.stiffness <= 0.0 or roll.stiffness <= 0.0:
            raise ValueError(
                f"BaseDriveCfg needs a slide and a roll with stiffness; the root of {endoscope.path.name} has none. "
                "Give the stage slide_drive and roll_drive (EndoscopeSpec), or drive the scope with TipPullCfg."
            )
        self._slide, self._roll = slide, roll
        self.force_limit = slide.max_force if cfg.force_limit is None else cfg.force_limit
        """Largest push [N]."""
        self.torque_limit = roll.max_force if cfg.torque_limit is None else cfg.torque_limit
        """Largest torque [N m]."""

    def modify_model(self, builder: newton.ModelBuilder, dofs: Sequence[int]) -> None:
        """Limit the forces of slide and roll."""
        for dof, limit in zip(dofs, (self.cfg.force_limit, self.cfg.torque_limit), strict=False):
            if limit is not None:
                builder.joint_effort_limit[dof] = limit

    def allocate(self, model: newton.Model, num_envs: int, device: str) -> None:
        """Make commands and averages."""
        self._num_envs, self._device = num_envs, device
        self._coords = model.joint_coord_count // num_envs
        self._springs = self._make_springs()
        self.velocity = wp.zeros(num_envs, dtype=float, device=device)
        """Commanded insertion [m/s], shape (W,)."""
        self.roll_rate = wp.zeros(num_envs, dtype=float, device=device)
        """Commanded roll [rad/s], shape (W,)."""
        self.force = wp.zeros(num_envs, dtype=float, device=device)
        """Push on the base, mean over the control step [N], shape (W,)."""
        self._explicit = wp.zeros((1, num_envs), dtype=float, device=device)
        self.commands, self.averages = [self.velocity, self.roll_rate], [self.force]
        self.readings = {"base_force": self.force}

    def _make_springs(self) -> kernels.BaseSprings:
        springs, stage = kernels.BaseSprings(), self.endoscope.stage
        springs.slide_stiffness, springs.slide_damping = self._slide.stiffness, self._slide.damping
        springs.force_limit, springs.torque_limit = self.force_limit, self.torque_limit
        springs.furthest = stage.total_length - stage.link_length[0] - self.endoscope.rest_insertion
        springs.roll_stiffness = self._roll.stiffness
        return springs

    def set_command(self, velocity: torch.Tensor, roll_rate: torch.Tensor) -> None:
        """Set the speed of the base, kept until changed.

        Args:
            velocity: Insertion [m/s], shape (N,).
            roll_rate: Roll about the shaft [rad/s], shape (N,).
        """
        wp.to_torch(self.velocity).copy_(velocity)
        wp.to_torch(self.roll_rate).copy_(roll_rate)

    def apply(self, state: newton.State, control: newton.Control, resistance: wp.array, dt: float) -> None:
        """Move the targets of slide and roll on."""
        inputs = [state.joint_q, self._coords, self._springs, self.velocity, self.roll_rate, dt]
        outputs = [control.joint_target_q]
        self._launch(kernels.drive_base, inputs, outputs)

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        """Add the force of the slide's drive."""
        self._launch(kernels.record_push, [drive_force, weight], [self.force])

    def record_explicit(self, state: newton.State, control: newton.Control, weight: float) -> None:
        """Add the force by the slide's spring law."""
        inputs = [state.joint_q, state.joint_qd, control.joint_target_q, self._coords, self._springs]
        self._launch(kernels.slide_force, inputs, [self._explicit])
        self.record(self._explicit, None, weight)

    def _launch(self, kernel: wp.Kernel, inputs: list, outputs: list) -> None:
        count, device = self._num_envs, self._device
        wp.launch(kernel, count, inputs=inputs, outputs=outputs, device=device, block_dim=WORLD_BLOCK)
