# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Reference coupling with plain Newton: ``SolverMuJoCo`` and ``SolverVBD`` under ``SolverCoupledProxy``.

It shares geometry, material, anchors, drives and contact stiffness with :class:`TwoLevelCoupling` and none of its
solver code. Expect a tenth of its speed and a wall that moves too little while it is pushed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
from newton.solvers import SolverMuJoCo, SolverVBD
from newton.solvers.experimental.coupled import SolverCoupledProxy

from arcgym.assets.anchors import AnchorSprings
from arcgym.sim import model_building
from arcgym.sim.coupling import newton_kernels
from arcgym.sim.simulation_cfg import SimulationCfg

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation

ANCHOR_RADIUS = 0.0005
"""Radius of the static particles that anchors are tied to [m]; they touch nothing."""
LEAST_SUBSTEPS = 2
"""Scope substeps that explicit contact forces need."""


def scope_solver(model: newton.Model, cfg: SimulationCfg) -> SolverMuJoCo:
    """MuJoCo for the articulations alone: contact with the wall comes in as link forces."""
    return SolverMuJoCo(
        model=model,
        disable_contacts=True,
        integrator="implicitfast",
        iterations=cfg.scope_iterations,
        ls_iterations=5,
        njmax=2 * model.joint_dof_count // model.world_count + 8,
        nconmax=8,
    )


class NewtonCoupling:
    """Steps a Newton model of scope and wall, and copies states in and out of the simulation's arrays."""

    def __init__(self, sim: Simulation):
        """Build the coupled model of all worlds."""
        self.sim, self.cfg = sim, sim.cfg
        self.model = self._model(sim)
        self.stride = self.model.particle_count // sim.num_envs
        self.now, self.then, self.control = self.model.state(), self.model.state(), self.model.control()
        self.solver = self._solver()

    def _model(self, sim: Simulation) -> newton.Model:
        world = _empty_builder()
        sim.colon.add_to(world)
        mobile = sim.colon.mobile()
        for i in np.flatnonzero(~mobile):
            _hold(world, int(i))
        springs = sim.colon.anchor_scale * _linear_springs(sim.colon.anchor_springs())
        for i in np.flatnonzero((springs > 0.0) & mobile):
            fixed = world.add_particle(world.particle_q[i], (0.0, 0.0, 0.0), mass=0.0, radius=ANCHOR_RADIUS)
            _hold(world, fixed)
            world.add_spring(fixed, int(i), float(springs[i]), 0.0, 0.0)
        sim.endoscope.add_to(world, self.cfg.mass_scaling)
        contact = self.cfg.contact
        for shape in range(world.shape_count):
            world.shape_material_ke[shape] = contact.stiffness
            world.shape_material_kd[shape] = 0.0
            world.shape_material_mu[shape] = contact.friction
        world.color()
        builder = _empty_builder()
        builder.replicate(world, sim.num_envs)
        model = builder.finalize(device=sim.device)
        model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = contact.stiffness, 0.0, contact.friction
        return model

    def _solver(self) -> SolverCoupledProxy:
        bodies, joints = list(range(self.model.body_count)), list(range(self.model.joint_count))
        entry, config, proxy = SolverCoupledProxy.Entry, SolverCoupledProxy.Config, SolverCoupledProxy.Proxy
        scope = entry(name="scope", solver=lambda view: scope_solver(view, self.cfg), bodies=bodies, joints=joints)
        wall = entry(
            name="wall",
            solver=lambda view: SolverVBD(
                model=view, iterations=self.cfg.newton_iterations, rigid_body_particle_contact_buffer_size=512
            ),
            particles=list(range(self.model.particle_count)),
        )
        link = proxy(source="scope", destination="wall", bodies=bodies, collision_pipeline=self._pipeline)
        return SolverCoupledProxy(
            model=self.model, entries=[scope, wall], coupling=config(proxies=[link], iterations=1)
        )

    def _pipeline(self, view: newton.Model) -> newton.CollisionPipeline:
        return newton.CollisionPipeline(
            view,
            soft_contact_gap=self.cfg.contact.search_gap,
            enable_rigid_soft_full_surface_contact=True,
            broad_phase="nxn",
            soft_contact_max=20000 * self.sim.num_envs,
        )

    def step(self) -> None:
        """Advance by one physics step, in place."""
        count = max(self.cfg.scope_substeps, LEAST_SUBSTEPS)
        dt = self.cfg.dt / count
        self._copy_in()
        for _ in range(count):
            self._damp(dt)
            self.now.clear_forces()
            self.sim.actuation.apply(self.now, self.control, self.sim.contact.ring, dt)
            self.sim.actuation.record_explicit(self.now, self.control, 1.0 / count)
            self.solver.step(self.now, self.then, self.control, None, dt)
            self._record(1.0 / count)
            self.now, self.then = self.then, self.now
        self._copy_out()

    def _record(self, weight: float) -> None:
        # SolverCoupledProxy offers the contact forces of its proxies nowhere else (Newton 1.8).
        wrench = self.solver._proxy_mappings[0].coupling_forces
        total = self.sim.scope_readout.step_force
        wp.launch(
            newton_kernels.add_coupling_forces,
            total.shape,
            inputs=[wrench, weight],
            outputs=[total],
            device=total.device,
        )

    def _damp(self, dt: float) -> None:
        velocity, factor = self.now.particle_qd, math.exp(-self.cfg.wall.drag * dt)
        wp.launch(newton_kernels.damp, velocity.shape, inputs=[factor], outputs=[velocity], device=velocity.device)

    def _copy_in(self) -> None:
        sim = self.sim
        for name in ("joint_q", "joint_qd", "body_q", "body_qd"):
            wp.copy(getattr(self.now, name), getattr(sim.state, name))
        wp.copy(self.control.joint_target_q, sim.control.joint_target_q)
        for ours, theirs in ((sim.nodal_pos, self.now.particle_q), (sim.nodal_vel, self.now.particle_qd)):
            wp.launch(
                newton_kernels.to_particles,
                ours.shape,
                inputs=[ours, self.stride],
                outputs=[theirs],
                device=ours.device,
            )

    def _copy_out(self) -> None:
        sim = self.sim
        for name in ("joint_q", "joint_qd", "body_q", "body_qd"):
            wp.copy(getattr(sim.state, name), getattr(self.now, name))
        wp.copy(sim.control.joint_target_q, self.control.joint_target_q)
        for theirs, ours in ((self.now.particle_q, sim.nodal_pos), (self.now.particle_qd, sim.nodal_vel)):
            wp.launch(
                newton_kernels.from_particles,
                ours.shape,
                inputs=[theirs, self.stride],
                outputs=[ours],
                device=ours.device,
            )

    def forward(self, world_mask: wp.array) -> None:
        """Recompute the links' poses in ``world_mask``, shape (W,), bool, after joints were written to."""
        state = self.sim.state
        newton.eval_fk(self.sim.model, state.joint_q, state.joint_qd, state, mask=world_mask)

    def reset(self, world_mask: wp.array) -> None:
        """Clear what the coupled solvers keep between steps in the masked worlds; states are copied in anyway."""
        self._copy_in()
        self.solver.reset(self.now, world_mask)


def _empty_builder() -> newton.ModelBuilder:
    builder = model_building.empty_builder()
    SolverMuJoCo.register_custom_attributes(builder)
    return builder


def _hold(builder: newton.ModelBuilder, particle: int) -> None:
    builder.particle_mass[particle] = 0.0
    builder.particle_flags[particle] &= ~int(newton.ParticleFlags.ACTIVE)


def _linear_springs(springs: AnchorSprings) -> np.ndarray:
    if springs.slack.any():
        raise ValueError("SimulationCfg.solver='newton' has no anchors with slack; choose material='paper'.")
    return springs.stiffness
