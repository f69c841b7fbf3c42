# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two-level solver of the wall: one coarse correction of the rings, then vertex block descent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.sim.contact.contact_search import ContactSearch
from arcgym.sim.contact.self_contact import SelfContact
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.simulation_cfg import WallSolverCfg
from arcgym.sim.wall import coarse_cpu_kernels, coarse_kernels, packed_contact_kernels, wall_kernels, weight_kernels
from arcgym.sim.wall.band_kernels import RingAxes, Rings
from arcgym.sim.wall.band_matrix_kernels import ENTRIES
from arcgym.sim.wall.block_tridiagonal import BlockTridiagonalSolver
from arcgym.sim.wall.gas_rings import GasRings
from arcgym.sim.wall.kept_rings import KeptRings
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.lumen_gas import LumenGas
from arcgym.sim.wall.packed_contact_kernels import FOURS
from arcgym.sim.wall.ring_modes import MODES, RingModes, band_elements
from arcgym.sim.wall.surroundings import Surroundings
from arcgym.sim.wall.wall_elements import wall_elements
from arcgym.sim.wall.wall_parameters import WallParameters, wall_nodes
from arcgym.sim.wall.wall_topology import ring_mean
from arcgym.sim.wall.wall_weight import WallWeight
from arcgym.utils.threaded_graph import in_parts, in_sequence, launch_rows
from arcgym.utils.warp_setup import GPU_BLOCK

REGULARIZATION = 1.0e-5
"""Shift of the coarse matrix, relative to each diagonal entry."""
ROUNDING = 2.0e-7
"""Residual of a vertex, over the stiffness of its elements, under which it is not swept [m]. Of rounding alone it is up
to 6e-8 (colon 1 at rest, every vertex swept, ``paper`` and ``in_situ``). A fixed 1 mN, as before, is 4e-6 in
``in_situ``, whose wall trembled at 0.5 mm/s; with less than this, 5 % of a CPU's physics step go into vertices that
hardly move."""


def wall_contacts(
    contact: ContactSearch, dt: float, x_prev: wp.array, body_q: wp.array, body_q_prev: wp.array
) -> wall_kernels.WallContacts:
    """Return the contacts of one wall step as a struct.

    Args:
        contact: Contacts found at the start of the step.
        dt: Its length [s].
        x_prev: Wall positions at its start [m], shape (V, W), vec3.
        body_q: Link poses at its end, shape (W*L,).
        body_q_prev: Link poses at its start, shape (W*L,).
    """
    contacts = wall_kernels.WallContacts()
    contacts.records, contacts.links, contacts.law = contact.records, contact.links, contact.law
    contacts.friction, contacts.dt, contacts.x_prev = contact.friction, dt, x_prev
    contacts.body_q, contacts.body_q_prev = body_q, body_q_prev
    return contacts


class WallSolver:
    """Steps the walls of all worlds in place.

    Vertex block descent alone converges slowly over a long tube: the error of a bent colon is smooth along its
    length. The coarse correction removes just that part, which makes one sweep a step enough.
    """

    def __init__(
        self,
        cfg: WallSolverCfg,
        walls: Sequence[WallParameters],
        modes: Sequence[RingModes],
        dt: float,
        patient: wp.array,
        contact_slots: int,
        device: str,
        gas: LumenGas | None = None,
        weight: WallWeight | None = None,
        law: WallLawCfg | None = None,
        surroundings: Surroundings | None = None,
    ):
        """Allocate the solver.

        Args:
            cfg: Solver settings.
            walls: Wall of each patient.
            modes: Its ring modes.
            dt: Physics step [s].
            patient: Patient of each world, shape (W,), int32, read in every step.
            contact_slots: Number of contact records of all worlds.
            device: Warp device.
            gas: Gas in the lumen, if there is any; advanced in every step.
            weight: Weight of the walls, if they weigh.
            law: How shells stretch; None for the plain law.
            surroundings: What else pushes or pulls on the walls, if anything does.
        """
        num_envs, first = len(patient), walls[0]
        self.cfg, self.dt, self.num_envs, self.device = cfg, dt, num_envs, device
        self.vertex_count, self.ring_count = len(first.points), len(modes[0].mass)
        mobile = np.any([wall.mobile for wall in walls], axis=0)
        self.moves = bool(mobile.any())
        self.nodes = wall_nodes(walls, patient, device)
        self.gas, self.weight, self.surroundings = gas, weight, surroundings
        self.elements = wall_elements(walls, patient, dt, device, None if gas is None else gas.loads, law)
        sizes = np.broadcast_to(self.elements.size, len(walls))
        self._rounding = wp.array(ROUNDING * sizes, dtype=float, device=device)
        self._kernels = self.elements.plain if surroundings is None else self.elements.surrounded
        self._measure_changed_bands = self.elements.measure_changed_bands if surroundings is None else None
        self.rings, self.loads = self._rings(walls, modes, patient)
        self.colors = [wp.array(c[mobile[c]], dtype=int, device=device) for c in first.colors if mobile[c].any()]
        self.tissue = wall_kernels.Tissue()
        self.tissue.moduli = wp.array(np.tile(first.moduli, (num_envs, 1)), dtype=wp.vec3, device=device)
        self.tissue.anchor = wp.ones(num_envs, dtype=float, device=device)
        self.tissue.rigid = wp.zeros(num_envs, dtype=int, device=device)
        count, rings = (self.vertex_count, num_envs), (self.ring_count, num_envs)
        self.x_prev, self.inertial, self.force = (wp.zeros(count, dtype=wp.vec3, device=device) for _ in range(3))
        self.shift = wp.zeros(rings, dtype=wp.vec3, device=device)
        self.axes = RingAxes()
        self.axes.p, self.axes.q = (wp.zeros(rings, dtype=wp.vec3, device=device) for _ in range(2))
        self.bands = wp.zeros((self.ring_count, ENTRIES, ENTRIES, num_envs), dtype=float, device=device)
        self.measured = self._measured_contacts(contact_slots)
        self.on_gpu = wp.get_device(device).is_cuda
        """Whether contacts are packed, see :mod:`.packed_contact_kernels`."""
        self.packed = wp.zeros(FOURS * contact_slots if self.on_gpu else 1, dtype=wp.vec4, device=device)
        """The packed contacts."""
        self._prepared = self._begun = False
        self.ring_system = BlockTridiagonalSolver(num_envs, self.ring_count, device)
        self.gas_rings = None if gas is None else GasRings(gas, self.ring_count)
        keeps = self.on_gpu and cfg.coarse_correction and self._measure_changed_bands is not None
        self.kept = KeptRings(self.vertex_count, self.ring_count, num_envs, device) if keeps else None
        """What is kept from step to step where the wall hardly moves, on a GPU."""
        self.self_contact = SelfContact(
            cfg, [wall.points for wall in walls], first.ring, modes[0].members, first.thickness, patient, device
        )
        if surroundings is not None:
            surroundings.bind(self.self_contact, [wall.points for wall in walls])

    def _measured_contacts(self, slots: int) -> wall_kernels.MeasuredContacts:
        measured = wall_kernels.MeasuredContacts()
        measured.stiffness = wp.zeros(slots, dtype=wp.vec2, device=self.device)
        for name in ("force", "normal", "own_fields", "next_fields"):
            setattr(measured, name, wp.zeros(slots, dtype=wp.vec3, device=self.device))
        return measured

    def forget(self, world_mask: wp.array) -> None:
        """Forget what is kept of the worlds in ``world_mask``, shape (W + 1,), bool, from step to step."""
        if self.kept is not None:
            self.kept.forget(world_mask)

    def _rings(
        self, walls: Sequence[WallParameters], modes: Sequence[RingModes], patient: wp.array
    ) -> tuple[Rings, coarse_kernels.RingLoads]:
        rings, loads, device, ring = Rings(), coarse_kernels.RingLoads(), self.device, walls[0].ring
        start, band = band_elements(self.elements.corners, ring)
        rings.patient = patient
        rings.ring = wp.array(ring, dtype=int, device=device)
        rings.plane = patient_array([one.plane for one in modes], wp.vec2, device)
        rings.bending = patient_array([one.bending for one in modes], wp.mat33, device)
        rings.moves = patient_array([one.moves.astype(np.int32) for one in modes], int, device)
        rings.band_start, rings.band = (wp.array(one, dtype=int, device=device) for one in (start, band))
        loads.members = wp.array(modes[0].members, dtype=int, device=device)
        loads.mass = patient_array([one.mass for one in modes], wp.mat33, device)
        loads.anchor = patient_array([one.anchor for one in modes], wp.mat33, device)
        loads.loose = patient_array([ring_mean(wall.anchor.loose, ring) for wall in walls], float, device)
        loads.slack = patient_array([ring_mean(wall.anchor.slack, ring) for wall in walls], float, device)
        loads.rest_center = patient_array([ring_mean(wall.points, ring) for wall in walls], wp.vec3, device)
        return rings, loads

    def prepare(self, x: wp.array, v: wp.array) -> None:
        """Begin a physics step with what takes the wall alone: where it would go by inertia, and what it is like there.

        Nothing of the scope is read, and ``x`` and ``v`` are not written to, so that the scope may move meanwhile.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            v: Wall velocities [m/s], shape (V, W), vec3.
        """
        if not self.moves:
            if self.gas is not None:
                self.gas.measure(x)
                self.gas.fit_rigid()
            return
        self.elements.advance(x, self.tissue)
        decay = math.exp(-self.cfg.drag * self.dt)
        inputs = [x, v, self.nodes, self.tissue, decay, self.cfg.largest_speed, self.dt]
        shape, outputs = (self.vertex_count, self.num_envs), [self.x_prev, self.inertial]
        if self.weight is None:
            self._launch_rows(wall_kernels.predict, shape, inputs, outputs)
        else:
            self._launch_rows(weight_kernels.predict_weighing, shape, [*inputs, *self.weight.inputs], outputs)
        self.self_contact.measure(x)
        if self.surroundings is not None:
            self.surroundings.measure(x, self.tissue, self.dt)
            self.surroundings.advance(x, v, self.self_contact, self.dt)
        if self.gas is not None:
            self.gas.measure(self.inertial)
        self._measure(self.inertial)
        self._prepared = True

    def begin_contacts(self, x: wp.array, contact: ContactSearch, body_q_prev: wp.array) -> None:
        """Begin with what takes the contacts alone, once they are found, while the scope moves.

        Args:
            x: Wall positions at the start of the step [m], shape (V, W), vec3.
            contact: Contacts found at the start of the step.
            body_q_prev: Link poses at its start, shape (W*L,).
        """
        if not self.moves:
            return
        records, inputs = contact.records, [contact.links, contact.law, contact.debt]
        self._launch(wall_kernels.share_debts, contact.debt.shape, inputs, [records])
        shape = (self.num_envs, records.threads)
        if self.cfg.coarse_correction:
            self._launch(coarse_kernels.measure_fields, shape, [self.rings, records], [self.measured])
        if self.on_gpu:
            self._pack(self._contacts(contact, x, body_q_prev, body_q_prev), x)
        self._begun = True

    def step(self, x: wp.array, v: wp.array, contact: ContactSearch, body_q: wp.array, body_q_prev: wp.array) -> None:
        """Advance the wall by one physics step, in place, with :meth:`prepare` and :meth:`begin_contacts` if not done.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            v: Wall velocities [m/s], shape (V, W), vec3.
            contact: Contacts found at the start of the step.
            body_q: Link poses at the end of the step, shape (W*L,).
            body_q_prev: Link poses at its start, shape (W*L,).
        """
        if not self.moves:
            return
        if not self._prepared:
            self.prepare(x, v)
        if not self._begun:
            self.begin_contacts(x, contact, body_q_prev)
        self._prepared = self._begun = False
        contacts = self._contacts(contact, self.x_prev, body_q, body_q_prev)
        start = self.inertial
        if not self.cfg.coarse_correction or self.gas_rings is not None:
            start = x
            wp.copy(x, self.inertial)
        for repeat in range(self.cfg.repeats):
            if repeat > 0:
                start = x
                if self.gas is not None:
                    self.gas.measure(x)
                self._measure(x)
            self._residual(start, self.inertial, contacts, self.force)
            if self.cfg.coarse_correction:
                self._correct_rings(start, x, contacts, repeat)
            for _ in range(self.cfg.iterations):
                self._sweep(x, contacts, contact.carried is None)
        self._launch_rows(wall_kernels.finish, x.shape, [x, self.x_prev, self.dt], [v])

    def finish_contacts(
        self, x: wp.array, contact: ContactSearch, body_q: wp.array, body_q_prev: wp.array, link_force: wp.array
    ) -> None:
        """Keep what friction holds and what the links owe the wall; arguments as in :meth:`step`.

        ``link_force`` is the mean force of the wall on each link in this step [N], shape (W*L,), vec3.
        """
        contacts = self._contacts(contact, self.x_prev if self.moves else x, body_q, body_q_prev)
        shape, measured = (self.num_envs, contacts.records.threads), self.measured
        packed = self.on_gpu and self.moves
        advance = packed_contact_kernels.advance_packed if packed else wall_kernels.advance_slides
        self._launch(advance, shape, [contacts, x], [measured])
        if self.moves:
            inputs = [contact.records, measured, link_force]
            self._launch(wall_kernels.settle_debts, contact.debt.shape, inputs, [contact.debt])

    def _contacts(
        self, contact: ContactSearch, x_prev: wp.array, body_q: wp.array, body_q_prev: wp.array
    ) -> wall_kernels.WallContacts:
        contacts = wall_contacts(contact, self.dt, x_prev, body_q, body_q_prev)
        contacts.packed = self.packed
        return contacts

    def _pack(self, contacts: wall_kernels.WallContacts, x: wp.array) -> None:
        shape = (self.num_envs, contacts.records.threads)
        self._launch(packed_contact_kernels.pack_contacts, shape, [contacts, x], [])

    def _sweep(self, x: wp.array, contacts: wall_kernels.WallContacts, together: bool) -> None:
        """Move the vertices color by color; those of a color ``together`` where no contact joins two of them."""
        sweep = self._kernels.sweep_packed if self.on_gpu else self._kernels.sweep_color
        inputs = [self.nodes, self.elements.data, self.tissue, self.inertial, contacts]
        inputs += [self.cfg.largest_move, self._rounding, self.force]
        for color in self.colors:

            def move(first: int, rows: int, color: wp.array = color) -> None:
                part = color[first : first + rows]
                self._launch(sweep, (rows, self.num_envs), [part, *inputs], [x])

            if together:
                in_parts(len(color), move)
            else:
                move(0, len(color))

    def _measure(self, x: wp.array) -> None:
        """Measure the elements at ``x``: their forces, and their stiffness in the rings' modes."""
        self.elements.measure(x, self.tissue)
        if not self.cfg.coarse_correction:
            return
        rings, shape, data = self.rings, (self.ring_count - 1, self.num_envs), self.elements.data
        if self.kept is not None:
            self.kept.place(x, rings, self.loads, self.axes, self.shift, self.tissue)
            inputs = [x, data, rings, self.axes, self.tissue, self.kept.rings.changed]
            self._launch_rows(self._measure_changed_bands, shape, inputs, [self.bands])
            return
        self._launch(coarse_kernels.place_rings, self.shift.shape, [x, rings, self.loads], [self.axes, self.shift])
        inputs = [x, data, rings, self.axes, self.tissue, None]
        self._launch_rows(self.elements.measure_bands, shape, inputs, [self.bands])

    def _residual(self, x: wp.array, inertial: wp.array, contacts: wall_kernels.WallContacts, force: wp.array) -> None:
        """Measure the contacts at ``x``, and sum all up to the ``force`` on every vertex."""
        contacts.self_contact = self.self_contact.force
        if self.surroundings is not None:
            contacts.outer = self.surroundings.force
        shape, measured = (self.num_envs, contacts.records.threads), self.measured
        measure = packed_contact_kernels.measure_packed if self.on_gpu else wall_kernels.measure_contacts
        self._launch(measure, shape, [contacts, x], [measured])
        if self.cfg.coarse_correction and wp.get_device(self.device).is_cpu:
            self._launch(coarse_cpu_kernels.list_touching, (self.num_envs,), [contacts.records], [measured])
        inputs = [self.nodes, self.elements.data, self.tissue, inertial, contacts, measured, x]
        self._launch_rows(self._kernels.residual, x.shape, inputs, [force])

    def _correct_rings(self, start: wp.array, x: wp.array, contacts: wall_kernels.WallContacts, repeat: int) -> None:
        """Solve for the modes of all rings and move every vertex with its ring, from ``start`` to ``x``."""
        system, rings, tissue = self.ring_system, self.rings, self.tissue
        if self.surroundings is None and self.gas_rings is None and wp.get_device(self.device).is_cpu:
            in_sequence(self.ring_count, lambda *rows: self._assemble(contacts, *rows), system.eliminate)
            system.substitute()
        else:
            if self.kept is not None:
                self.kept.find_rows(contacts.records, contacts.self_contact)
            in_parts(self.ring_count, lambda *rows: self._assemble(contacts, *rows))
            if self.surroundings is not None:
                self.surroundings.add_rows(rings, tissue, system.diagonal)
            if self.gas_rings is not None:
                ends = (repeat == 0, repeat == self.cfg.repeats - 1)
                self.gas_rings.solve(self.elements.data.shell, rings, self.loads, tissue, system, *ends)
                self.gas_rings.prolong(rings, system, self.cfg.largest_move, x)
                return
            if self.kept is not None:
                system.solve_changed(self.kept.rows)
            else:
                system.solve()
        self._launch_rows(coarse_kernels.prolong, x.shape, [rings, system.rhs, self.cfg.largest_move, start], [x])

    def _assemble(self, contacts: wall_kernels.WallContacts, first: int, rows: int) -> None:
        """Write some rows of the rings' equations."""
        system = self.ring_system
        if wp.get_device(self.device).is_cpu:
            inputs = [first, self.force, self.rings, self.loads, self.tissue]
            self._launch(coarse_cpu_kernels.sum_forces, (rows, self.num_envs), inputs, [system.rhs])
        inputs = [first, self.force, self.rings, self.loads, self.bands, self.shift, self.tissue, 1.0 / self.dt**2]
        kernel, kept = coarse_kernels.assemble, KeptRows()
        if self.kept is not None:
            kernel, kept = coarse_kernels.assemble_changed, self.kept.rows
        self._launch(
            kernel,
            (rows, self.num_envs, MODES),
            [*inputs, REGULARIZATION, contacts.records, self.measured, contacts.self_contact, kept],
            [system.diagonal, system.upper, system.rhs],
        )

    def _launch_rows(self, kernel: wp.Kernel, shape: tuple[int, ...], inputs: list[Any], outputs: list[Any]) -> None:
        launch_rows(kernel, shape, inputs, outputs, self.device)

    def _launch(self, kernel: wp.Kernel, shape: tuple[int, ...], inputs: list[Any], outputs: list[Any]) -> None:
        wp.launch(kernel, shape, inputs=inputs, outputs=outputs, device=self.device, block_dim=GPU_BLOCK)
