# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Coarse correction of the wall: every ring moves by x_i += t + p_i g_p + q_i g_q, see ``ring_modes``.

The matrix is that of the wall's present shape: elements as ``band_kernels`` measures them, inertia, anchors at the
shift of the ring's center, the contacts at hand with the scope and of the wall with itself. As it is nowhere softer
than the wall (negative parts count as zero, bending along the colon by its bound), a step does not raise the energy
that it is computed from. What is left of an error therefore shrinks from step to step, whatever shape the wall is in,
and no correction has to be held back.

Launch dimensions: R rings, V wall vertices, W worlds last.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.sim.contact.self_contact_kernels import SelfContactForce
from arcgym.sim.wall.anchor_kernels import secant_share
from arcgym.sim.wall.band_kernels import RingAxes, Rings
from arcgym.sim.wall.band_matrix_kernels import band_entry
from arcgym.sim.wall.block_tridiagonal_kernels import MODES, Unknowns
from arcgym.sim.wall.kept_rows_kernels import KeptRows, first_kept
from arcgym.sim.wall.row_store_kernels import store_row, store_row_if
from arcgym.sim.wall.wall_kernels import MeasuredContacts, Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length
from arcgym.utils.on_cpu_kernels import on_cpu
from arcgym.utils.warp_setup import FAST


@wp.struct
class RingLoads:
    """What acts on the rings of the wall of each of P patients besides elements and contacts."""

    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    mass: wp.array2d[wp.mat33]  # sum of mass times the products of (1, p, q) [kg], shape (R, P)
    anchor: wp.array2d[wp.mat33]  # the same of the tight springs [N/m], shape (R, P)
    loose: wp.array2d[float]  # share of them within the slack, shape (R, P)
    slack: wp.array2d[float]  # [m], shape (R, P)
    rest_center: wp.array2d[wp.vec3]  # mean rest position of the ring's vertices [m], shape (R, P)


@wp.func
def place_ring(
    x: wp.array2d[wp.vec3],
    rings: Rings,
    loads: RingLoads,
    axes: RingAxes,
    shift: wp.array2d[wp.vec3],
    r: int,
    w: int,
):
    """Measure how ring ``r`` of world ``w`` lies and how far its center has moved since rest, see ``place_rings``."""
    patient = rings.patient[w]
    total = wp.vec3(0.0)
    p = wp.vec3(0.0)
    q = wp.vec3(0.0)
    count = float(0.0)
    for k in range(loads.members.shape[1]):
        i = loads.members[r, k]
        if i >= 0:
            here = x[i, w]
            total += here
            p += rings.plane[i, patient][0] * here
            q += rings.plane[i, patient][1] * here
            count += 1.0
    shift[r, w] = total / count - loads.rest_center[r, patient]
    p = wp.normalize(p)
    axes.p[r, w] = p
    axes.q[r, w] = wp.normalize(q - wp.dot(p, q) * p)


@wp.kernel
def place_rings(x: wp.array2d[wp.vec3], rings: Rings, loads: RingLoads, axes: RingAxes, shift: wp.array2d[wp.vec3]):
    """Measure how each ring lies and how far its center has moved since rest. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        rings: Rings of all patients.
        loads: Loads of all patients.
        axes: Directions of the rings; written.
        shift: Shift of each ring's center [m], shape (R, W); written.
    """
    r, w = wp.tid()
    place_ring(x, rings, loads, axes, shift, r, w)


@wp.func
def ring_fields(rings: Rings, i: int, p: int) -> wp.vec3:
    """Return (1, p, q) at vertex ``i`` of patient ``p``."""
    plane = rings.plane[i, p]
    return wp.vec3(1.0, plane[0], plane[1])


@wp.func
def point_fields(rings: Rings, f: wp.vec4i, u: wp.vec4, r: int, p: int) -> wp.vec3:
    """Return how far the point that vertices ``f`` carry by ``u`` moves with each vector of ring ``r``."""
    out = wp.vec3(0.0)
    for k in range(4):
        if u[k] != 0.0 and rings.ring[f[k]] == r:
            out += u[k] * ring_fields(rings, f[k], p)
    return out


@wp.func
def add_share(row: Unknowns, fields: wp.vec3, push: wp.vec3) -> Unknowns:
    """Add a push on a point to what it does to each unknown of a ring that moves the point by ``fields``."""
    out = row
    for k in range(3):
        for c in range(3):
            out[3 * k + c] = out[3 * k + c] + fields[k] * push[c]
    return out


@wp.func
def axis(i: int) -> wp.vec3:
    """Return the unit vector along axis ``i``. (A vector indexed by a variable would be kept out of the registers.)"""
    return wp.vec3(wp.where(i == 0, 1.0, 0.0), wp.where(i == 1, 1.0, 0.0), wp.where(i == 2, 1.0, 0.0))


@wp.func
def contact_stiffness_times(normal: wp.vec3, stiffness: wp.vec2, move: wp.vec3) -> wp.vec3:
    """Return the stiffness of a contact, along its normal and across it, times a displacement of its point."""
    return ((stiffness[0] - stiffness[1]) * wp.dot(normal, move)) * normal + stiffness[1] * move


@wp.kernel
def measure_fields(rings: Rings, records: ContactRecords, measured: MeasuredContacts):
    """Write how far every contact's point moves with the vectors of its two rings. Launch (W, T).

    Args:
        rings: Rings of all patients.
        records: Contacts.
        measured: ``own_fields`` and ``next_fields`` are written.
    """
    w, thread = wp.tid()
    slot = w * records.capacity + thread
    end = w * records.capacity + records.start[w, records.start.shape[1] - 1]
    p = rings.patient[w]
    while slot < end:
        r = records.ring[slot]
        corners = records.corners[slot]
        shares = records.bary[slot]
        measured.own_fields[slot] = point_fields(rings, corners, shares, r, p)
        measured.next_fields[slot] = point_fields(rings, corners, shares, r + 1, p)
        slot += records.threads


@wp.func
def anchor_row(
    rings: Rings, loads: RingLoads, shift: wp.vec3, r: int, field: wp.vec3, along: wp.vec3, p: int
) -> Unknowns:
    """Return the anchors' stiffness between an unknown and all of ring ``r`` [N/m], see ``anchor_hessian``.

    Args:
        rings: Rings of all patients.
        loads: Loads of all patients.
        shift: Shift of the ring's center [m].
        r: Ring.
        field: Which of t, g_p and g_q the unknown is part of.
        along: Axis of the unknown.
        p: Patient.
    """
    d = wp.length(shift)
    secant = secant_share(d, loads.loose[r, p], loads.slack[r, p])
    springs = loads.anchor[r, p]
    row = add_share(Unknowns(), secant * (springs * field), along)
    if secant < 1.0 and d > loads.slack[r, p]:
        tight = (1.0 - secant) * springs[0, 0] * field[0] * wp.dot(shift, along) / (d * d)
        row = add_share(row, wp.vec3(tight, 0.0, 0.0), shift)
    return row


@wp.func
def self_contact_row(
    rings: Rings, loads: RingLoads, contact: SelfContactForce, r: int, field: wp.vec3, along: wp.vec3, w: int
) -> Unknowns:
    """Return the self-contact stiffness between an unknown, as in ``anchor_row``, and all of ring ``r`` [N/m]."""
    out = Unknowns()
    for j in range(loads.members.shape[1]):
        v = loads.members[r, j]
        if v >= 0:
            stiffness = contact.stiffness[v, w]
            if stiffness > 0.0:
                plane = contact.plane[v, w]
                n = wp.vec3(plane[0], plane[1], plane[2])
                fields = ring_fields(rings, v, rings.patient[w])
                out = add_share(out, fields, (stiffness * wp.dot(fields, field) * wp.dot(n, along)) * n)
    return out


@wp.func
def next_unknown(i: int) -> int:
    """Return the unknown of a band that unknown ``i`` of its next ring is part of: t's with the other sign."""
    return wp.where(i < 3, i, i + 6)


@wp.func
def next_sign(i: int) -> float:
    """Return the sign with which unknown ``i`` of a ring is part of that of the band before."""
    return wp.where(i < 3, -1.0, 1.0)


def _assemble_kernel(keeps: bool) -> wp.Kernel:
    """Make the kernel that assembles the equations: all of them, or but for the rows that are kept."""

    @wp.kernel(module="unique", module_options=FAST)
    def assemble(
        first: int,
        force: wp.array2d[wp.vec3],
        rings: Rings,
        loads: RingLoads,
        bands: wp.array4d[float],
        shift: wp.array2d[wp.vec3],
        tissue: Tissue,
        inv_dt2: float,
        regularization: float,
        records: ContactRecords,
        measured: MeasuredContacts,
        self_contact: SelfContactForce,
        kept: KeptRows,
        diagonal: wp.array4d[float],
        upper: wp.array4d[float],
        rhs: wp.array3d[float],
    ):
        """Assemble one row of the coarse system of every world.

        Launch (R, W, M), or some of the rows, in blocks of ``GPU_BLOCK``.

        Args:
            first: First row of this launch.
            force: Residual of each vertex [N], shape (V, W).
            rings: Rings of all patients.
            loads: Loads of all patients.
            bands: Stiffness of each band between its unknowns [N/m], upper half, shape (R, 15, 15, W).
            shift: Shift of each ring's center [m], shape (R, W).
            tissue: Values of each world.
            inv_dt2: One over the squared physics step [1/s^2].
            regularization: Relative addition to the diagonal.
            records: Contacts, listed by ring.
            measured: Their normals and stiffness.
            self_contact: Contact of the wall with itself.
            kept: Rows of which only the right-hand side is written, if ``keeps``.
            diagonal: Blocks of the rings [N/m], shape (R, W, M, M); written.
            upper: Blocks from each ring to the next [N/m], shape (R, W, M, M); written.
            rhs: Force on each unknown [N], shape (R, W, M); written, on a CPU by
                :func:`arcgym.sim.wall.coarse_cpu_kernels.sum_forces`.
        """
        r, w, a = wp.tid()
        r += first
        field = axis(a // 3)
        along = axis(a % 3)
        p = rings.patient[w]
        count = loads.mass.shape[0]
        own_row = Unknowns()
        next_row = Unknowns()
        total = float(0.0)
        free = rings.moves[r, p] == 1 and tissue.rigid[w] == 0
        next_free = int(0)
        if r + 1 < count:
            next_free = rings.moves[r + 1, p]
        works = free
        light = int(count)
        if wp.static(keeps):
            light = first_kept(kept, count, w)
            works = free and r < light
        if works:
            own_row = add_share(Unknowns(), inv_dt2 * (loads.mass[r, p] * field), along)
            own_row += tissue.anchor[w] * anchor_row(rings, loads, shift[r, w], r, field, along, p)
            for i in range(MODES):
                if r + 1 < count:
                    own_row[i] = own_row[i] + band_entry(bands, r, a, i, w)
                if r > 0:
                    behind = band_entry(bands, r - 1, next_unknown(a), next_unknown(i), w)
                    own_row[i] = own_row[i] + next_sign(a) * next_sign(i) * behind
                if next_free == 1:
                    next_row[i] = next_sign(i) * band_entry(bands, r, a, next_unknown(i), w)
            for i in range(MODES):  # own_row[a], which would keep the row out of the registers
                if i == a:
                    own_row[i] = own_row[i] * (1.0 + regularization) + 1.0e-6
            if self_contact.in_contact[r, w] == 1:
                own_row += self_contact_row(rings, loads, self_contact, r, field, along, w)
        if free and not on_cpu():
            for j in range(loads.members.shape[1]):
                v = loads.members[r, j]
                fields = ring_fields(rings, wp.max(v, 0), p)
                push = force[wp.max(v, 0), w]
                if v >= 0:
                    total += wp.dot(fields, field) * wp.dot(push, along)
        if works:
            for which in range(2):
                lowest = r - which
                slot = int(-1)
                if lowest >= 0:
                    slot = records.ring_head[lowest, w]
                while slot >= 0:
                    stiffness = measured.stiffness[slot]
                    normal = measured.normal[slot]
                    own_fields = measured.own_fields[slot]
                    next_fields = measured.next_fields[slot]
                    slot = records.ring_next[slot]
                    if stiffness[0] > 0.0:
                        fields = own_fields
                        if which == 1:
                            fields = next_fields
                        push = contact_stiffness_times(normal, stiffness, wp.dot(fields, field) * along)
                        own_row = add_share(own_row, fields, push)
                        if which == 0 and next_free == 1:
                            next_row = add_share(next_row, next_fields, push)
        if not free:
            for i in range(MODES):
                own_row[i] = wp.where(i == a, 1.0, 0.0)
        if not on_cpu():
            rhs[r, w, a] = total
        if wp.static(keeps):
            store_row_if(diagonal, r, w, a, own_row, r < light)
            store_row_if(upper, r, w, a, next_row, r < light - 1)
        else:
            store_row(diagonal, r, w, a, own_row)
            store_row(upper, r, w, a, next_row)

    return assemble


assemble = _assemble_kernel(False)
assemble_changed = _assemble_kernel(True)


@wp.kernel
def prolong(
    first: int,
    rings: Rings,
    solution: wp.array3d[float],
    largest_move: float,
    start: wp.array2d[wp.vec3],
    x: wp.array2d[wp.vec3],
):
    """Move every vertex with its ring. Launch (V, W), or some of the rows.

    Args:
        first: First row of this launch.
        rings: Rings of all patients.
        solution: Amplitude of each unknown [m], shape (R, W, M).
        largest_move: Longest displacement of a vertex [m].
        start: Wall positions before [m], shape (V, W); may be ``x``.
        x: Wall positions [m], shape (V, W); written.
    """
    i, w = wp.tid()
    i += first
    r = rings.ring[i]
    fields = ring_fields(rings, i, rings.patient[w])
    d = wp.vec3(0.0)
    for k in range(3):
        d += fields[k] * wp.vec3(solution[r, w, 3 * k], solution[r, w, 3 * k + 1], solution[r, w, 3 * k + 2])
    x[i, w] = start[i, w] + clamp_length(d, largest_move)
