# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two-way coupling of the scope (articulated chain) with the wall (two-level solver), one physics step at a time."""

from __future__ import annotations

from typing import Protocol

import newton
import warp as wp

from arcgym.sim.contact import link_load_kernels
from arcgym.sim.contact.contact_search import ContactSearch
from arcgym.sim.scope.actuation import Actuation
from arcgym.sim.scope.scope_solver import SolverArticulatedChain
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.sim.wall.wall_solver import WallSolver


class Coupling(Protocol):
    """Advances scope and wall together."""

    def step(self) -> None:
        """Advance by one physics step, in place; adds each link's mean wall force to the simulation's array."""

    def forward(self) -> None:
        """Recompute the links' poses after joints were written to."""

    def reset(self, world_mask: wp.array) -> None:
        """Forget what the solvers remember of the worlds in ``world_mask``, shape (W + 1,), bool."""


class TwoLevelCoupling:
    """One wall step with K scope substeps in it.

    Contacts are found once a step. Each scope substep re-evaluates their depth against the link's new pose, implicitly;
    the wall solve then sees the scope's final pose. **What is stale:** the contact points, and for the scope the place
    of the wall, stay put for one step, which acts like a normal dashpot of stiffness * dt where the wall gives way.
    Moving the wall on at its velocity meanwhile would undo that, but sets light walls swinging.
    """

    def __init__(
        self,
        cfg: SimulationCfg,
        model: newton.Model,
        state: newton.State,
        control: newton.Control,
        actuation: Actuation,
        contact: ContactSearch,
        wall: WallSolver,
        x: wp.array,
        v: wp.array,
        wall_force: wp.array,
        pierced: wp.array,
    ):
        """Connect the parts; all arrays are changed in place by :meth:`step`.

        Args:
            cfg: Simulation settings.
            model: Newton model of all scopes.
            state: Newton state of all scopes.
            control: Newton control of all scopes.
            actuation: Commands and drives.
            contact: Contact search.
            wall: Wall solver.
            x: Wall positions [m], shape (V, W), vec3.
            v: Wall velocities [m/s], shape (V, W), vec3.
            wall_force: Sum of mean link forces [N], shape (W*L,), vec3.
            pierced: Set to 1 where the axis of a link is about to get behind the wall, or there, shape (W,).
        """
        self.cfg, self.model, self.control = cfg, model, control
        self.actuation, self.contact, self.wall = actuation, contact, wall
        self.x, self.v, self.wall_force, self.pierced = x, v, wall_force, pierced
        self.solver = SolverArticulatedChain(model)
        self.solver.resistance = actuation.resistance
        self.state = state
        self.body_q_prev = wp.clone(state.body_q)
        """Link poses at the start of the last step, shape (W*L,)."""

    def step(self) -> None:
        """Advance by one physics step, in place."""
        count = self.cfg.scope_substeps
        dt = self.cfg.dt / count
        wp.copy(self.body_q_prev, self.state.body_q)
        self.contact.detect(self.x, self.state.body_q)
        for _ in range(count):
            self._load_contacts(dt)
            self.actuation.apply(self.state, self.control, self.contact.ring, dt)
            self.solver.step(self.state, self.state, self.control, None, dt)
            self._record(1.0 / count)
        self.wall.step(self.x, self.v, self.contact, self.state.body_q, self.body_q_prev)

    def _load_contacts(self, dt: float) -> None:
        contact, state, loads = self.contact, self.state, self.solver.loads
        args = [state.body_q, state.body_qd, self.model.body_com, self.x, self.v, contact.links, contact.records]
        args += [contact.law, contact.friction, dt, loads, self.pierced]
        wp.launch(link_load_kernels.load_contacts, loads.wrench.shape, args, device=self.model.device)

    def _record(self, weight: float) -> None:
        loads, work = self.solver.loads, self.solver.work
        args = [loads, work.acc_lin, work.acc_ang, weight, self.wall_force]
        wp.launch(link_load_kernels.record_forces, loads.wrench.shape, args, device=self.model.device)
        self.actuation.record(work.drive_force, work.acc_lin, weight)

    def forward(self) -> None:
        """Recompute the links' poses after joints were written to."""
        self.solver.forward(self.state)

    def reset(self, world_mask: wp.array) -> None:
        """Nothing to forget: neither solver keeps anything from step to step."""
