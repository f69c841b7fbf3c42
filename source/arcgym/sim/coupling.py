# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two-way coupling of the scope (MuJoCo) with the wall (two-level solver), one physics step at a time."""

from __future__ import annotations

from typing import Protocol

import newton
import warp as wp
from newton.solvers import SolverMuJoCo

from arcgym.sim.actuation import Actuation
from arcgym.sim.contact import ContactSearch
from arcgym.sim.contact_kernels import link_forces
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.sim.wall_solver import WallSolver


class Coupling(Protocol):
    """Advances scope and wall together."""

    def step(self) -> None:
        """Advance by one physics step, in place; adds each link's mean wall force to the simulation's array."""

    def reset(self, world_mask: wp.array) -> None:
        """Forget what the solvers remember of the worlds in ``world_mask``, shape (W + 1,), bool."""


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


class TwoLevelCoupling:
    """One wall step with K scope substeps in it.

    Contacts are found once a step. Each scope substep re-evaluates their depth against the link's new pose, the wall
    moving on at its velocity; the wall solve then sees the scope's final pose. **What is stale:** the contact points
    stay put for one step, which acts like a normal dashpot of about stiffness * dt.
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
            x: Wall positions [m], shape (W*V,).
            v: Wall velocities [m/s], shape (W*V,).
            wall_force: Sum of mean link forces [N], shape (W*L,).
        """
        self.cfg, self.model, self.control = cfg, model, control
        self.actuation, self.contact, self.wall = actuation, contact, wall
        self.x, self.v, self.wall_force = x, v, wall_force
        self.solver = scope_solver(model, cfg)
        self.state, self._other = state, model.state()
        self._body_q_prev = wp.clone(state.body_q)

    def step(self) -> None:
        """Advance by one physics step, in place."""
        count = self.cfg.scope_substeps
        dt = self.cfg.dt / count
        wp.copy(self._body_q_prev, self.state.body_q)
        self.contact.detect(self.x, self.state.body_q)
        now, then = self.state, self._other
        for substep in range(count):
            self._contact_forces(now, substep * dt, dt)
            self.actuation.apply(now, self.control, dt, 1.0 / count)
            self.solver.step(now, then, self.control, None, dt)
            now, then = then, now
        self.wall.step(self.x, self.v, self.contact, now.body_q, self._body_q_prev)

    def _contact_forces(self, state: newton.State, elapsed: float, dt: float) -> None:
        contact = self.contact
        wp.launch(
            link_forces,
            state.body_q.shape,
            [state.body_q, state.body_qd, self.model.body_mass, self.x, self.v, contact.links, contact.records]
            + [contact.law, contact.friction, elapsed, dt, 1.0 / self.cfg.scope_substeps, contact.link_count]
            + [state.body_f, self.wall_force],
            device=self.model.device,
        )

    def reset(self, world_mask: wp.array) -> None:
        """Clear MuJoCo's warm starts in the masked worlds."""
        self.solver.reset(self.state, world_mask, 0)
