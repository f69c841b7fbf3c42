# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Commands of all worlds and the forces that follow them."""

from __future__ import annotations

import newton
import numpy as np
import warp as wp

from arcgym.assets.endoscope import Endoscope
from arcgym.sim import actuation_kernels as kernels
from arcgym.sim.simulation_cfg import SimulationCfg


class Actuation:
    """Turns commands into joint targets and link forces, substep by substep.

    A scope with a driven base (stiffness in its slide) is pushed and bent; any other is pulled by its tip.
    """

    def __init__(self, cfg: SimulationCfg, endoscope: Endoscope, model: newton.Model, num_envs: int, device: str):
        """Allocate commands and their state.

        Args:
            cfg: Simulation settings.
            endoscope: The scope.
            model: Newton model of all worlds' scopes.
            num_envs: Worlds, W.
            device: Warp device.
        """
        self.cfg, self.scope, self.stage = cfg, endoscope.cfg, endoscope.stage
        self.num_envs, self.device, self.link_count = num_envs, device, endoscope.num_bodies
        self.coords = model.joint_coord_count // num_envs
        self.dofs = model.joint_dof_count // num_envs
        self.body_mass = model.body_mass
        self.pushed = endoscope.kind == "proximal"
        self.rest_insertion = endoscope.rest_insertion
        self.pull, self.drive = self._pull(), self._drive()
        self.insertion_velocity = wp.zeros(num_envs, dtype=float, device=device)
        self.roll_rate = wp.zeros(num_envs, dtype=float, device=device)
        self.bending_command = wp.zeros(num_envs, dtype=wp.vec2, device=device)
        self.tip_lin_command = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.tip_ang_command = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.bending = wp.zeros(num_envs, dtype=wp.vec2, device=device)
        self.lead = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.turn = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.base_force = wp.zeros(num_envs, dtype=float, device=device)
        self.tip_force = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self._share, self._bend_limit = self._bending_section()

    def _pull(self) -> kernels.TipPull:
        pull = kernels.TipPull()
        for name in ("stiffness", "damping", "force_limit", "angular_stiffness", "angular_damping", "torque_limit"):
            setattr(pull, name, getattr(self.scope.tip_pull, name))
        return pull

    def _drive(self) -> kernels.BaseDrive:
        drive = kernels.BaseDrive()
        slide, roll = self.stage.slide_drive, self.stage.roll_drive
        if self.pushed and slide is not None and roll is not None:
            drive.slide_stiffness, drive.slide_damping = slide.stiffness, slide.damping
            drive.force_limit = _override(self.scope.insertion_force_limit, slide.max_force)
            drive.furthest = self.stage.total_length - self.stage.link_length[0] - self.rest_insertion
            drive.roll_stiffness = roll.stiffness
            drive.torque_limit = _override(self.scope.roll_torque_limit, roll.max_force)
        return drive

    def _bending_section(self) -> tuple[wp.vec2, wp.vec2]:
        """Reciprocal hinge counts and total limits [rad] of (pitch, yaw)."""
        bent = self.stage.bending_links
        if bent == 0:
            return wp.vec2(0.0, 0.0), wp.vec2(0.0, 0.0)
        hinge = np.arange(self.link_count - bent, self.link_count)
        limit = self.stage.hinge_limit[hinge - 1]
        odd = hinge % 2 == 1
        share = wp.vec2(1.0 / max(odd.sum(), 1), 1.0 / max((~odd).sum(), 1))
        return share, wp.vec2(float(limit[odd].sum()), float(limit[~odd].sum()))

    def apply(self, state: newton.State, control: newton.Control, dt: float, weight: float) -> None:
        """Add this substep's forces to ``state.body_f`` and write ``control.joint_target_q``.

        Args:
            state: State at the start of the substep.
            control: Newton control, changed in place.
            dt: Substep [s].
            weight: Share of the substep in the force averages.
        """
        if self.stage.root == "slide_roll":
            self._guide(state)
        if self.pushed:
            self._push(state, control, dt, weight)
        else:
            self._pull_tip(state, dt, weight)
        if any(self.cfg.gravity):
            args = [self.body_mass, wp.vec3(*self.cfg.gravity), self.cfg.mass_scaling, state.body_f]
            wp.launch(kernels.add_gravity, self.num_envs * self.link_count, args, device=self.device)

    def _guide(self, state: newton.State) -> None:
        guide = self.scope.introducer
        args = [state.body_q, state.body_qd, guide.stiffness, guide.damping, guide.height, guide.radius, state.body_f]
        wp.launch(kernels.guide_base, self.num_envs * self.link_count, args, device=self.device)

    def _push(self, state: newton.State, control: newton.Control, dt: float, weight: float) -> None:
        target = control.joint_target_q
        args = [state.joint_q, state.joint_qd, self.coords, self.dofs, self.drive, self.insertion_velocity]
        args += [self.roll_rate, dt, weight, target, self.base_force]
        wp.launch(kernels.drive_base, self.num_envs, args, device=self.device)
        bent = self.stage.bending_links
        args = [self.bending_command, self.scope.bending_rate, self._bend_limit, dt, self.link_count - bent, bent]
        args += [self.coords, self._share, self.bending, target]
        wp.launch(kernels.drive_bending, self.num_envs, args, device=self.device)

    def _pull_tip(self, state: newton.State, dt: float, weight: float) -> None:
        args = [state.body_q, state.body_qd, self.link_count, self.pull, self.tip_lin_command, self.tip_ang_command]
        args += [dt, weight, self.lead, self.turn, state.body_f, self.tip_force]
        wp.launch(kernels.pull_tip, self.num_envs, args, device=self.device)


def _override(value: float | None, default: float) -> float:
    return default if value is None else value
