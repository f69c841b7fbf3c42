# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two-way coupling of the scope (articulated chain) with the wall (two-level solver), one physics step at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import warp as wp

from arcgym.sim.contact import link_load_block_kernels as block_kernels
from arcgym.sim.contact import link_load_kernels as kernels
from arcgym.sim.scope.scope_solver import SolverArticulatedChain
from arcgym.utils.side_stream import SideStream
from arcgym.utils.threaded_graph import at_the_same_time
from arcgym.utils.warp_vote_kernels import GROUP

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


class Coupling(Protocol):
    """Advances scope and wall together."""

    def step(self) -> None:
        """Advance by one physics step, in place; adds each link's mean wall force to the simulation's array."""

    def forward(self, world_mask: wp.array) -> None:
        """Recompute the links' poses in ``world_mask``, shape (W,), bool, after joints were written to."""

    def reset(self, world_mask: wp.array) -> None:
        """Forget what the solvers remember of the worlds in ``world_mask``, shape (W + 1,), bool."""


class TwoLevelCoupling:
    """One wall step with K scope substeps in it.

    Contacts are found once a step. Each scope substep re-evaluates their depth against the link's new pose, implicitly;
    the wall solve then sees the scope's final pose.

    On a GPU contacts are found and the scope moves on a stream of its own while the wall prepares its step: the chain's
    solver keeps few of the processors busy, and neither reads what the other writes.

    **Stale within a step:** the contact points, and for the scope the place of the wall. That acts like a normal
    dashpot of stiffness * dt where the wall yields. Moving the wall on at its velocity meanwhile would undo that, but
    sets light walls swinging.
    """

    def __init__(self, sim: Simulation):
        """Make the scope solver, and allocate.

        Args:
            sim: Simulation whose model, state, actuation, contact search, wall solver and scope readout are built.
        """
        self.sim = sim
        self.solver = SolverArticulatedChain(sim.model)
        self.solver.resistance = sim.actuation.resistance
        self.body_q_prev = wp.clone(sim.state.body_q)
        """Link poses at the start of the last step, shape (W*L,), transform."""
        rows = self.body_q_prev.shape[0] if self.solver.by_warp else 0
        self._motions = wp.zeros(rows, dtype=kernels.MovingLink, device=sim.device)
        self._on_gpu = wp.get_device(sim.device).is_cuda
        self._scope_stream = wp.Stream(sim.device, priority=-1) if self._on_gpu else None
        self._side, self._drives = SideStream(sim.device), SideStream(sim.device, priority=-1)

    def step(self) -> None:
        """Advance by one physics step, in place."""
        self.move()
        self.finish_contacts()

    def move(self) -> None:
        """Do :meth:`step` but for :meth:`finish_contacts`."""
        if self._scope_stream is None:
            at_the_same_time(self.move_scope, self.prepare_wall)
        else:
            with wp.ScopedStream(self._scope_stream):
                self.move_scope()
            self.prepare_wall()
            wp.get_stream(self.sim.device).wait_stream(self._scope_stream)
        sim = self.sim
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, self.body_q_prev)

    def move_scope(self) -> None:
        """Find the contacts and advance the scope by a physics step."""
        sim, contact = self.sim, self.sim.contact
        if self._scope_stream is None:
            self.find_contacts()
            sim.wall.begin_contacts(sim.nodal_pos, contact, self.body_q_prev)
            self._move_scope()
            return
        wp.copy(self.body_q_prev, sim.state.body_q)
        contact.follow(sim.nodal_pos, sim.state.body_q)
        with self._drives.scope():
            self._drive()
        contact.find(sim.nodal_pos, sim.state.body_q)
        with self._side.scope():
            contact.order()
            sim.wall.begin_contacts(sim.nodal_pos, contact, self.body_q_prev)
        self._move_scope()
        self._side.join()

    def prepare_wall(self) -> None:
        """Begin the wall's step; may be done at the same time as :meth:`move_scope`."""
        self.sim.wall.prepare(self.sim.nodal_pos, self.sim.nodal_vel)

    def finish_contacts(self) -> None:
        """Keep what friction holds and what the links owe the wall; the wall is read, not moved."""
        sim, link_force = self.sim, self.sim.scope_readout.step_force
        sim.wall.finish_contacts(sim.nodal_pos, sim.contact, sim.state.body_q, self.body_q_prev, link_force)

    def _move_scope(self) -> None:
        """Advance the scope by all substeps of a physics step; of the wall, positions and velocities are read."""
        sim, state, work = self.sim, self.sim.state, self.solver.work
        count = sim.cfg.scope_substeps
        dt = sim.cfg.dt / count
        for k in range(count):
            if k > 0 or not self._on_gpu:
                with self._drives.scope():
                    self._drive()
            self.load_contacts(k * dt, dt)
            self._drives.join()
            self.solver.move(state, state, sim.control, dt, sim.scope_readout.step_force, 1.0 / count)
            with self._drives.scope():
                sim.actuation.record(work.drive_force, work.acc_lin, 1.0 / count)
        self._drives.join()

    def _drive(self) -> None:
        """Write what drives and joints do in a substep that begins, for which no contact has to be known."""
        sim, dt = self.sim, self.sim.cfg.dt / self.sim.cfg.scope_substeps
        sim.actuation.apply(sim.state, sim.control, sim.contact.ring, dt)
        self.solver.prepare(sim.state, sim.control, dt)

    def find_contacts(self) -> None:
        """Begin a step: remember where the links are, and find their contacts."""
        wp.copy(self.body_q_prev, self.sim.state.body_q)
        self.sim.contact.detect(self.sim.nodal_pos, self.sim.state.body_q)

    def load_contacts(self, elapsed: float, dt: float) -> None:
        """Write the loads of the contacts on the links for a substep of ``dt`` [s], ``elapsed`` [s] into a step."""
        sim, contact, solver = self.sim, self.sim.contact, self.solver
        inputs = [sim.state.body_q, sim.state.body_qd, sim.model.body_com, sim.nodal_pos, sim.nodal_vel]
        inputs += [contact.links, contact.records, contact.law, contact.friction, self.body_q_prev, elapsed, dt]
        outputs, worlds = [solver.loads, sim.scope_readout.penetrated], solver.num_envs
        if not solver.by_warp:
            shape = (solver.chain.links, worlds)
            wp.launch(kernels.load_contacts, shape, inputs=inputs, outputs=outputs, device=sim.device)
            return
        wp.launch(
            block_kernels.load_contacts_by_block,
            (worlds, block_kernels.THREADS),
            inputs=[*inputs, block_kernels.THREADS, GROUP],
            outputs=[self._motions, *outputs],
            device=sim.device,
            block_dim=block_kernels.THREADS,
        )

    def forward(self, world_mask: wp.array) -> None:
        """Recompute the links' poses in ``world_mask``, shape (W,), bool, after joints were written to."""
        self.solver.forward(self.sim.state, world_mask)

    def reset(self, world_mask: wp.array) -> None:
        """Have the wall's solver measure anew what it keeps while nothing moves."""
        self.sim.wall.forget(world_mask)
