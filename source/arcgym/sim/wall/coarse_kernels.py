# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Coarse correction of the wall: every ring moves in a few modes, x_i += R_r sum_k b_ik c_k, with R_r its rotation.

The modes turn with their ring, so the elastic matrix is the rest matrix for every pose; inertia and isotropic anchors
do not turn at all. Anchors with slack are taken at the shift of the ring's centre. Only the contacts at hand, with
the scope and of the wall with itself, are added in each step.

Launch dimensions: R rings, V wall vertices, W worlds last.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.sim.contact.self_contact_kernels import SelfContactForce
from arcgym.sim.wall.anchor_kernels import secant_share
from arcgym.sim.wall.block_tridiagonal_kernels import MODES, Unknowns
from arcgym.sim.wall.wall_kernels import MeasuredContacts, Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length

DILATION = wp.constant(6)
"""Mode that moves every vertex by its place in the ring's plane over the ring's size."""
DENTED = wp.constant(0.03)
"""Distortion from which a ring takes half of the correction; an undistorted ring takes it whole. The modes are those
of the ring's shape at rest. In a dented ring they strain it instead of turning it as a whole, and the wall is stiffer
in them than the matrix says: where it holds a shaft in a bend up to four times (generalised eigenvalue 3.95). A
correction of more than twice what is right grows without bound: those walls trembled by 0.3 mm a step. (A matrix made
stiffer there ends that, too, but then the wall cannot get out of the way of a link that is shoved at it.)"""


@wp.struct
class RingSpace:
    """Ring modes of the wall of each of P patients."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    ring: wp.array[int]  # ring of each vertex, shape (V,)
    basis: wp.array3d[wp.vec3]  # displacement of each vertex in each mode, zero where it is held, shape (V, M, P)
    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    frame_weights: wp.array2d[wp.vec2]  # in-plane coordinates (p, q) over the rms radius, shape (V, P)
    rest_frame: wp.array2d[wp.mat33]  # rest ring frame, columns p, q, p x q, shape (R, P)
    stiffness: wp.array4d[Unknowns]  # rows of the three elastic parts' diagonal blocks [N/m], shape (3, R, M, P)
    coupling: wp.array4d[Unknowns]  # rows of their blocks to the next ring [N/m], shape (3, R, M, P)
    mass: wp.array3d[Unknowns]  # rows [kg], shape (R, M, P)
    anchor: wp.array3d[Unknowns]  # rows of the tight springs [N/m], shape (R, M, P)
    loose: wp.array2d[float]  # share of them within the slack, shape (R, P)
    slack: wp.array2d[float]  # [m], shape (R, P)
    rest_center: wp.array2d[wp.vec3]  # mean rest position of the ring's vertices [m], shape (R, P)


@wp.kernel
def ring_rotations(
    x: wp.array2d[wp.vec3],
    space: RingSpace,
    rotation: wp.array2d[wp.mat33],
    shift: wp.array2d[wp.vec3],
    distortion: wp.array2d[float],
):
    """Measure how each ring has turned, moved and changed its shape since rest. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        space: Ring modes of all patients.
        rotation: Rotation of each ring, shape (R, W); written.
        shift: Shift of each ring's centre [m], shape (R, W); written.
        distortion: Mean square of the vertices' way from where the turned, scaled ring would have them, over the mean
            square of their distance from the centre, shape (R, W); written.
    """
    r, w = wp.tid()
    patient = space.patient[w]
    total = wp.vec3(0.0)
    count = float(0.0)
    p = wp.vec3(0.0)
    q = wp.vec3(0.0)
    for k in range(space.members.shape[1]):
        i = space.members[r, k]
        if i >= 0:
            p += space.frame_weights[i, patient][0] * x[i, w]
            q += space.frame_weights[i, patient][1] * x[i, w]
            total += x[i, w]
            count += 1.0
    shift[r, w] = total / count - space.rest_center[r, patient]
    p = wp.normalize(p)
    q = wp.normalize(q - p * wp.dot(p, q))
    turn = wp.matrix_from_cols(p, q, wp.cross(p, q)) * wp.transpose(space.rest_frame[r, patient])
    rotation[r, w] = turn
    squares = float(0.0)
    along = float(0.0)
    for k in range(space.members.shape[1]):
        i = space.members[r, k]
        if i >= 0:
            here = x[i, w] - total / count
            squares += wp.length_sq(here)
            along += wp.dot(here, turn * space.basis[i, DILATION, patient])
    size = wp.sqrt(squares / count)
    distortion[r, w] = wp.max(2.0 - 2.0 * along / (count * wp.max(size, 1.0e-6)), 0.0)


@wp.func
def point_move(space: RingSpace, f: wp.vec4i, u: wp.vec4, r: int, m: int, p: int) -> wp.vec3:
    """Return the displacement in mode ``m`` of ring ``r`` of the point that ``f`` carry by ``u``, in the rest frame."""
    out = wp.vec3(0.0)
    for k in range(4):
        if u[k] != 0.0 and space.ring[f[k]] == r:
            out += u[k] * space.basis[f[k], m, p]
    return out


@wp.func
def apply_contact_stiffness(measured: MeasuredContacts, slot: int, move: wp.vec3) -> wp.vec3:
    """Return the stiffness of a contact times a displacement of its point [N]."""
    n = measured.normal[slot]
    k = measured.stiffness[slot]
    return ((k[0] - k[1]) * wp.dot(n, move)) * n + k[1] * move


@wp.func
def ring_share(space: RingSpace, f: wp.vec4i, u: wp.vec4, r: int, direction: wp.vec3, p: int) -> Unknowns:
    """Return how far each mode of ring ``r`` moves the point that ``f`` carry by ``u`` along ``direction``."""
    out = Unknowns()
    for k in range(4):
        if u[k] != 0.0 and space.ring[f[k]] == r:
            for m in range(MODES):
                out[m] = out[m] + u[k] * wp.dot(space.basis[f[k], m, p], direction)
    return out


@wp.func
def anchor_row(space: RingSpace, shift: wp.vec3, back: wp.mat33, r: int, a: int, p: int) -> Unknowns:
    """Return the anchor stiffness of ring ``r`` between mode ``a`` and all modes [N/m], see ``anchor_hessian``."""
    d = wp.length(shift)
    secant = secant_share(d, space.loose[r, p], space.slack[r, p])
    row = secant * space.anchor[r, a, p]
    if a < 3 and secant < 1.0 and d > space.slack[r, p]:
        along = back * shift
        tight = (1.0 - secant) * space.anchor[r, 0, p][0] * along[a] / (d * d)
        for c in range(3):
            row[c] = row[c] + tight * along[c]
    return row


@wp.func
def self_contact_row(
    space: RingSpace, self_contact: SelfContactForce, back: wp.mat33, r: int, a: int, w: int
) -> Unknowns:
    """Return the self-contact stiffness of ring ``r`` between its mode ``a`` and all of its modes [N/m]."""
    out = Unknowns()
    p = space.patient[w]
    for k in range(space.members.shape[1]):
        v = space.members[r, k]
        if v >= 0:
            stiffness = self_contact.stiffness[v, w]
            if stiffness > 0.0:
                plane = self_contact.plane[v, w]
                n = back * wp.vec3(plane[0], plane[1], plane[2])
                pull = stiffness * wp.dot(space.basis[v, a, p], n)
                for c in range(MODES):
                    out[c] = out[c] + pull * wp.dot(space.basis[v, c, p], n)
    return out


@wp.kernel
def assemble(
    force: wp.array2d[wp.vec3],
    space: RingSpace,
    rotation: wp.array2d[wp.mat33],
    shift: wp.array2d[wp.vec3],
    tissue: Tissue,
    inv_dt2: float,
    regularisation: float,
    records: ContactRecords,
    measured: MeasuredContacts,
    self_contact: SelfContactForce,
    diagonal: wp.array4d[float],
    upper: wp.array4d[float],
    rhs: wp.array3d[float],
):
    """Assemble one row of the system, mode ``a`` of ring ``r``. Launch (R, W, M).

    Args:
        force: Force on each vertex [N], shape (V, W).
        space: Ring modes of all patients.
        rotation: Rotation of each ring, shape (R, W).
        shift: Shift of each ring's centre [m], shape (R, W).
        tissue: Values of each world.
        inv_dt2: One over the squared physics step [1/s^2].
        regularisation: Relative addition to the diagonal.
        records: Contacts, listed by ring.
        measured: Their normals and stiffness.
        self_contact: Contact of the wall with itself.
        diagonal: Blocks of the rings [N/m], shape (R, W, M, M); written.
        upper: Blocks from each ring to the next [N/m], shape (R, W, M, M); written.
        rhs: Force on each mode [N], shape (R, W, M); written.
    """
    r, w, a = wp.tid()
    p = space.patient[w]
    rings = space.mass.shape[0]
    moduli = tissue.moduli[w]
    back = wp.transpose(rotation[r, w])
    own_row = inv_dt2 * space.mass[r, a, p] + tissue.anchor[w] * anchor_row(space, shift[r, w], back, r, a, p)
    next_row = Unknowns()
    for part in range(3):
        own_row += moduli[part] * space.stiffness[part, r, a, p]
        next_row += moduli[part] * space.coupling[part, r, a, p]
    for c in range(MODES):  # own_row[a], which would keep the row out of the registers
        if c == a:
            own_row[c] = own_row[c] * (1.0 + regularisation) + 1.0e-6
    if self_contact.in_contact[r, w] == 1:
        own_row += self_contact_row(space, self_contact, back, r, a, w)
    total = float(0.0)
    for k in range(space.members.shape[1]):
        v = space.members[r, k]
        if v >= 0:
            total += wp.dot(space.basis[v, a, p], back * force[v, w])
    rhs[r, w, a] = total
    for which in range(2):
        lowest = r - which
        slot = int(-1)
        if lowest >= 0:
            slot = records.ring_head[lowest, w]
        while slot >= 0:
            if measured.stiffness[slot][0] > 0.0:
                f = records.corners[slot]
                u = records.bary[slot]
                push = apply_contact_stiffness(measured, slot, rotation[r, w] * point_move(space, f, u, r, a, p))
                own_row += ring_share(space, f, u, r, back * push, p)
                if which == 0 and r + 1 < rings:
                    next_row += ring_share(space, f, u, r + 1, wp.transpose(rotation[r + 1, w]) * push, p)
            slot = records.ring_next[slot]
    for c in range(MODES):
        diagonal[r, w, a, c] = own_row[c]
        upper[r, w, a, c] = next_row[c]


@wp.kernel
def prolong(
    space: RingSpace,
    rotation: wp.array2d[wp.mat33],
    distortion: wp.array2d[float],
    solution: wp.array3d[float],
    largest_move: float,
    x: wp.array2d[wp.vec3],
):
    """Move every vertex with its ring. Launch (V, W).

    Args:
        space: Ring modes of all patients.
        rotation: Rotation of each ring, shape (R, W).
        distortion: Change of each ring's shape, shape (R, W).
        solution: Amplitude of each mode [m], shape (R, W, M).
        largest_move: Longest displacement of a vertex [m].
        x: Wall positions [m], shape (V, W); moved in place.
    """
    i, w = wp.tid()
    p = space.patient[w]
    r = space.ring[i]
    d = wp.vec3(0.0)
    for m in range(MODES):
        d += solution[r, w, m] * space.basis[i, m, p]
    d = d / (1.0 + wp.min(distortion[r, w] / DENTED, 1.0))
    x[i, w] = x[i, w] + rotation[r, w] * clamp_length(d, largest_move)
