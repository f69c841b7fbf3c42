# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Loads that move the scopes of all worlds: weight, introducer and the actuators of the endoscope."""

from __future__ import annotations

import math

import newton
import numpy as np
import torch
import warp as wp

from arcgym.assets.endoscope import Endoscope
from arcgym.sim.scope import actuation_kernels as kernels
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.utils.side_stream import SideStream


class Actuation:
    """Loads the links and runs the endoscope's actuators, in their order, substep by substep. W worlds, L links."""

    def __init__(self, cfg: SimulationCfg, endoscope: Endoscope, model: newton.Model, num_envs: int, device: str):
        """Allocate the actuators' arrays.

        Args:
            cfg: Simulation settings.
            endoscope: The scope.
            model: Newton model of all worlds' scopes.
            num_envs: Worlds, W.
            device: Warp device.
        """
        self.num_envs, self.device, self.link_count = num_envs, device, endoscope.num_bodies
        self.coords = model.joint_coord_count // num_envs
        self.body_mass = model.body_mass
        self.actuators = endoscope.actuators
        for actuator in self.actuators.values():
            actuator.allocate(model, num_envs, device)
        self.resistance = wp.zeros((num_envs, self.link_count), dtype=wp.spatial_vector, device=device).transpose()
        """Diagonal of the drop of ``state.body_f`` by the links' acceleration [kg], [kg m^2], shape (L, W); the links
        of a world lie side by side."""
        self._guide = self._introducer(endoscope)
        gravity = cfg.weight.gravity(cfg.weight.posture) if cfg.weight.enabled else cfg.gravity
        self.gravity = wp.full(num_envs, wp.vec3(*gravity), dtype=wp.vec3, device=device)
        """Acceleration of free fall in each world [m/s^2], shape (W,), vec3."""
        self._mass_scaling = cfg.mass_scaling
        self._weights = SideStream(device, priority=-1)

    def _introducer(self, endoscope: Endoscope) -> kernels.Introducer:
        guide, cfg = kernels.Introducer(), endoscope.cfg.introducer
        rest, guide.height, guide.min_height = endoscope.rest_height, cfg.height, -cfg.slack
        if endoscope.stage.root == "free":
            rest, guide.height = np.full(self.link_count, 1.0), -math.inf
            guide.min_height = float(endoscope.half_length[0])
        guide.rest = wp.array(rest, dtype=float, device=self.device)
        guide.stiffness, guide.damping = cfg.stiffness_per_length, cfg.damping_per_length
        guide.length = wp.array(endoscope.stage.link_length, dtype=float, device=self.device)
        return guide

    @property
    def memory(self) -> dict[str, wp.array]:
        """State that the drives keep, as ``<actuator>.<array>``, W entries each."""
        pairs = [(name, actuator.memory) for name, actuator in self.actuators.items()]
        return {f"{name}.{key}": array for name, memory in pairs for key, array in memory.items()}

    @property
    def averages(self) -> list[wp.array]:
        """Forces that are added up over a control step, W entries each."""
        return [array for actuator in self.actuators.values() for array in actuator.averages]

    def apply(self, state: newton.State, control: newton.Control, link_ring: wp.array, dt: float) -> None:
        """Write this substep's ``state.body_f``, :attr:`resistance` and ``control.joint_target_q``.

        Args:
            state: State at the start of the substep.
            control: Newton control, changed in place.
            link_ring: Ring of the colon that each link is in, shape (W, L).
            dt: Substep [s].
        """
        inputs = [state.body_q, state.body_qd, self.body_mass, self.gravity, self._mass_scaling, self._guide]
        inputs += [state.joint_q, self.coords, link_ring, dt]
        outputs = [state.body_f, self.resistance]
        shape = (self.num_envs, self.link_count)
        with self._weights.scope():
            wp.launch(kernels.load_links, shape, inputs=inputs, outputs=outputs, device=self.device)
        for actuator in self.actuators.values():
            if actuator.loads_links:
                self._weights.join()
            actuator.apply(state, control, self.resistance, dt)
        self._weights.join()

    def record(self, drive_force: wp.array, acceleration: wp.array, weight: float) -> None:
        """Add the substep's forces of the drives to their averages.

        Args:
            drive_force: Forces of the joint drives [N], shape (D, W).
            acceleration: Linear accelerations of the links [m/s^2], shape (L, W).
            weight: Share of the substep in the averages.
        """
        for actuator in self.actuators.values():
            actuator.record(drive_force, acceleration, weight)

    def record_explicit(self, state: newton.State, control: newton.Control, weight: float) -> None:
        """Do as :meth:`record` for solvers that do not report the drives' forces."""
        for actuator in self.actuators.values():
            actuator.record_explicit(state, control, weight)

    def reset(self, env_ids: torch.Tensor) -> None:
        """Zero commands and force averages of some worlds, after their state was written.

        Args:
            env_ids: World indices, int64, shape (n,).
        """
        for actuator in self.actuators.values():
            actuator.reset(env_ids)
