# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Commands of all worlds and the forces that follow them."""

from __future__ import annotations

import math

import newton
import numpy as np
import warp as wp

from arcgym.assets.endoscope import Endoscope
from arcgym.sim.scope import actuation_kernels as kernels
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
        self.resistance = wp.zeros((self.link_count, num_envs), dtype=wp.spatial_vector, device=device)
        """Diagonal of the drop of ``state.body_f`` by the links' acceleration [kg], [kg m^2], shape (L, W)."""
        self._pull_force = wp.zeros(num_envs, dtype=wp.vec4, device=device)
        self._slide_force = wp.zeros((1, num_envs), dtype=float, device=device)
        self._still = wp.zeros((1, num_envs), dtype=wp.vec3, device=device)
        self._guide = self._introducer(endoscope)
        self._gravity = wp.vec3(*cfg.gravity) / cfg.mass_scaling
        self._share, self._bend_limit = self._bending_section()
        bends = self.stage.bend_coords[self.link_count - 1 - self.stage.bending_links :]
        self._bend_coords = wp.array(bends, dtype=int, device=device)

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

    def _introducer(self, endoscope: Endoscope) -> kernels.Introducer:
        guide, cfg = kernels.Introducer(), self.scope.introducer
        rest, guide.height, guide.min_height = endoscope.rest_height, cfg.height, -cfg.slack
        if self.stage.root == "free":
            rest, guide.height, guide.min_height = (
                np.full(self.link_count, 1.0),
                -math.inf,
                float(endoscope.half_length[0]),
            )
        guide.rest = wp.array(rest, dtype=float, device=self.device)
        guide.stiffness, guide.damping = cfg.stiffness, cfg.damping
        return guide

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

    def apply(self, state: newton.State, control: newton.Control, link_ring: wp.array, dt: float) -> None:
        """Write this substep's ``state.body_f``, :attr:`resistance` and ``control.joint_target_q``.

        Args:
            state: State at the start of the substep.
            control: Newton control, changed in place.
            link_ring: Ring of the colon that each link is in, shape (W, L).
            dt: Substep [s].
        """
        args = [state.body_q, state.body_qd, self.body_mass, self._gravity, self._guide]
        args += [state.joint_q, self.coords, link_ring, dt]
        shape = (self.link_count, self.num_envs)
        wp.launch(kernels.load_links, shape, [*args, state.body_f, self.resistance], device=self.device)
        if self.pushed:
            self._push(state, control, dt)
        else:
            self._pull_tip(state, dt)

    def _push(self, state: newton.State, control: newton.Control, dt: float) -> None:
        target = control.joint_target_q
        args = [state.joint_q, self.coords, self.drive, self.insertion_velocity, self.roll_rate, dt, target]
        wp.launch(kernels.drive_base, self.num_envs, args, device=self.device)
        first = self.link_count - self.stage.bending_links
        args = [self.bending_command, self.scope.bending_rate, self._bend_limit, dt, first]
        args += [self._bend_coords, self.coords, self._share, self.bending, target]
        wp.launch(kernels.drive_bending, self.num_envs, args, device=self.device)

    def _pull_tip(self, state: newton.State, dt: float) -> None:
        args = [state.body_q, state.body_qd, self.pull, self.tip_lin_command, self.tip_ang_command, dt]
        args += [self.lead, self.turn, state.body_f, self.resistance, self._pull_force]
        wp.launch(kernels.pull_tip, self.num_envs, args, device=self.device)

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        """Add the substep's push or pull to the force averages.

        Args:
            drive_force: Forces of the joint drives [N], shape (D, W).
            acceleration: Linear accelerations of the links [m/s^2], shape (L, W).
            weight: Share of the substep in the averages.
        """
        if self.pushed:
            args = [drive_force, weight, self.base_force]
            wp.launch(kernels.record_push, self.num_envs, args, device=self.device)
        else:
            args = [self._pull_force, acceleration, weight, self.tip_force]
            wp.launch(kernels.record_pull, self.num_envs, args, device=self.device)

    def record_explicit(self, state: newton.State, control: newton.Control, weight: float) -> None:
        """As :meth:`record`, for solvers that do not tell what the drives do."""
        if self.pushed:
            args = [state.joint_q, state.joint_qd, control.joint_target_q, self.coords, self.drive, self._slide_force]
            wp.launch(kernels.slide_force, self.num_envs, args, device=self.device)
        self.record(self._slide_force, self._still, weight)


def _override(value: float | None, default: float) -> float:
    return default if value is None else value
