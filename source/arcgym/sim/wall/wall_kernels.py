# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Parts common to walls of both kinds: vertices with mass and anchor, contact, the start and the end of a step.

W worlds, V wall vertices; arrays of vertices have the shape (V, W), so that neighboring GPU threads, which work on
neighboring worlds, read neighboring memory.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import (
    ContactLaw,
    ContactRecords,
    LinkShapes,
    approach_damping,
    contact_geometry,
    normal_force,
    slide_stiffness,
    touched,
)
from arcgym.sim.contact.self_contact_kernels import SelfContactForce
from arcgym.sim.wall.anchor_kernels import Anchors, anchor_hessian, anchor_pull
from arcgym.sim.wall.outer_force_kernels import OuterForce, outer_force
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length


@wp.struct
class WallNodes:
    """Vertices of the wall of each of P patients."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    mass: wp.array2d[float]  # [kg], shape (V, P)
    mobile: wp.array2d[int]  # 1 where the vertex moves, shape (V, P)
    anchors: Anchors


@wp.struct
class Tissue:
    """Values that may differ from world to world."""

    moduli: wp.array[wp.vec3]  # shear, second Lame parameter, bending: solid [Pa, Pa, -], shell [N/m, N/m, N m]
    anchor: wp.array[float]  # factor on the anchor springs, shape (W,)
    rigid: wp.array[int]  # 1 where the whole wall stays where it is, shape (W,)


@wp.struct
class VertexBlock:
    """Force [N] on one vertex and the positive definite part of its Hessian [N/m]."""

    force: wp.vec3
    hessian: wp.mat33


MOVE_TOLERANCE = wp.constant(1.0e-7)
"""Move by the ring correction under which it counts as not moved [m]."""


@wp.func
def converged(force: wp.vec3, correction: wp.vec3, noise: float) -> bool:
    """Return whether a vertex needs no sweep.

    Args:
        force: Force on it [N].
        correction: Its move by the ring correction [m].
        noise: Force that is rounding alone [N].
    """
    return wp.length_sq(force) < noise * noise and wp.length_sq(correction) < MOVE_TOLERANCE * MOVE_TOLERANCE


@wp.func
def inertia_and_anchor(
    nodes: WallNodes, tissue: Tissue, inertial: wp.vec3, x: wp.vec3, i: int, w: int, inv_dt2: float
) -> VertexBlock:
    """Return the block of the vertex's inertia and of its spring to the rest position."""
    inertia = nodes.mass[i, nodes.patient[w]] * inv_dt2
    scale = tissue.anchor[w]
    block = VertexBlock()
    block.force = inertia * (inertial - x) + scale * anchor_pull(nodes.anchors, i, w, x)
    block.hessian = inertia * wp.identity(n=3, dtype=float) + scale * anchor_hessian(nodes.anchors, i, w, x)
    return block


@wp.struct
class WallContacts:
    """Contacts of one wall step, and how the links and the wall have moved in it."""

    records: ContactRecords
    links: LinkShapes
    law: ContactLaw
    self_contact: SelfContactForce
    outer: OuterForce  # read by kernels for walls with surroundings alone
    friction: wp.array[float]  # Coulomb coefficient, shape (W,)
    dt: float  # physics step [s]
    x_prev: wp.array2d[wp.vec3]  # wall positions at the start of the step [m], shape (V, W)
    body_q: wp.array[wp.transform]  # link poses at its end, shape (W*L,)
    body_q_prev: wp.array[wp.transform]  # and at its start, shape (W*L,)
    packed: wp.array[wp.vec4]  # on a GPU what a step leaves as it is, see ``packed_contact_kernels``, shape (9*W*S,)


@wp.struct
class ContactForce:
    """Force of one contact on the wall: ``normal_force * normal - friction * slip``."""

    normal_force: float  # [N]
    stiffness: float  # along the normal [N/m]
    friction: float  # secant stiffness across the normal [N/m]
    normal: wp.vec3  # unit vector from the scope into the wall
    slip: wp.vec3  # of the wall along the link, elastic part and that of this step [m]


@wp.func
def contact_force_at(contacts: WallContacts, slot: int, x: wp.array2d[wp.vec3], w: int) -> ContactForce:
    """Return the force of the contact in ``slot`` at the positions ``x`` of world ``w``; zero where nothing touches."""
    out = ContactForce()
    link = contacts.records.link[slot]
    row = w * contacts.links.radius.shape[0] + link
    p = touched(contacts.records, slot, x, w)
    radius = contacts.links.radius[link] + contacts.law.wall_radius
    c = contact_geometry(
        p, contacts.records.normal[slot], contacts.body_q[row], contacts.links.half_length[link], radius
    )
    if c.gap < 0.0:
        share = contacts.records.weight[slot]
        push = share * normal_force(contacts.law, -c.gap)
        out.normal_force = push[0]
        out.stiffness = push[1]
        out.normal = c.normal
        local = wp.transform_point(wp.transform_inverse(contacts.body_q[row]), p)
        before = touched(contacts.records, slot, contacts.x_prev, w)
        slip = wp.transform_point(contacts.body_q_prev[row], local) - before
        opening = wp.dot(c.normal, slip)
        if opening < 0.0:
            damping = share * approach_damping(contacts.law, -c.gap) / contacts.dt
            out.normal_force -= damping * opening
            out.stiffness += damping
        slip = slip - c.normal * opening
        held = contacts.records.slide[slot]
        out.slip = slip - held + wp.dot(c.normal, held) * c.normal
        speed = wp.length(slip) / contacts.dt
        out.friction = slide_stiffness(contacts.law, share, contacts.friction[w], out.normal_force, out.slip, speed)
    return out


@wp.func
def add_contact(block: VertexBlock, contacts: WallContacts, x: wp.array2d[wp.vec3], i: int, w: int) -> VertexBlock:
    """Add the contacts listed for vertex ``i`` of world ``w``; friction works on the slip of this step."""
    out = block
    eye = wp.identity(n=3, dtype=float)
    entry = contacts.records.vertex_head[i, w]
    while entry >= 0:
        slot = entry // 4
        weight = contacts.records.bary[slot][entry - 4 * slot]
        c = contact_force_at(contacts, slot, x, w)
        if c.normal_force > 0.0:
            along = wp.outer(c.normal, c.normal)
            out.force += weight * (c.normal_force * c.normal - c.friction * c.slip)
            out.hessian += (weight * weight) * (c.stiffness * along + c.friction * (eye - along))
        out.force += weight * contacts.records.owed[slot]
        entry = contacts.records.vertex_next[entry]
    return out


@wp.struct
class MeasuredContacts:
    """Contacts measured at the start of a wall solve, by record slot; zero where nothing touches."""

    force: wp.array[wp.vec3]  # on the wall [N]
    normal: wp.array[wp.vec3]  # from the scope into the wall
    stiffness: wp.array[wp.vec2]  # along the normal and across it [N/m]
    own_fields: wp.array[wp.vec3]  # how far the point moves with each vector of its lowest ring, see ``ring_modes``
    next_fields: wp.array[wp.vec3]  # and with those of the next ring


@wp.kernel
def measure_contacts(contacts: WallContacts, x: wp.array2d[wp.vec3], measured: MeasuredContacts):
    """Measure every contact at wall positions ``x``. Launch (W, T)."""
    w, thread = wp.tid()
    slot = w * contacts.records.capacity + thread
    end = w * contacts.records.capacity + contacts.records.start[w, contacts.links.radius.shape[0]]
    while slot < end:
        c = contact_force_at(contacts, slot, x, w)
        measured.force[slot] = c.normal_force * c.normal - c.friction * c.slip + contacts.records.owed[slot]
        measured.normal[slot] = c.normal
        measured.stiffness[slot] = wp.vec2(c.stiffness, c.friction)
        slot += contacts.records.threads


@wp.func
def depth_sum(records: ContactRecords, w: int, link: int, touch: float) -> float:
    """Return the sum over a link's contacts of weight times depth under the distance ``touch`` from its axis [m]."""
    total = float(0.0)
    first = w * records.capacity
    for k in range(records.start[w, link], records.start[w, link + 1]):
        total += records.weight[first + k] * wp.max(touch - records.distance[first + k], 0.0)
    return total


@wp.kernel
def share_debts(links: LinkShapes, law: ContactLaw, debt: wp.array2d[wp.vec3], records: ContactRecords):
    """Have every link pay its debt to the wall, by depth where it touches, else where it is near. Launch (W, L).

    Args:
        links: Capsules of one world.
        law: Contact law.
        debt: Impulse over the step that each link owes the wall [N], shape (W, L).
        records: Contacts; ``owed`` is written.
    """
    w, link = wp.tid()
    first = w * records.capacity
    touch = links.radius[link] + law.wall_radius
    total = depth_sum(records, w, link, touch)
    if total == 0.0:
        touch += law.search_gap
        total = depth_sum(records, w, link, touch)
    for k in range(records.start[w, link], records.start[w, link + 1]):
        depth = records.weight[first + k] * wp.max(touch - records.distance[first + k], 0.0)
        records.owed[first + k] = (depth / wp.max(total, 1.0e-12)) * debt[w, link]


@wp.kernel
def advance_slides(contacts: WallContacts, x: wp.array2d[wp.vec3], measured: MeasuredContacts):
    """Keep of every contact's displacement along the wall what friction holds, and measure its force. Launch (W, T).

    Args:
        contacts: Contacts of the step.
        x: Wall positions at its end [m], shape (V, W).
        measured: ``force`` is written.
    """
    w, thread = wp.tid()
    slot = w * contacts.records.capacity + thread
    end = w * contacts.records.capacity + contacts.records.start[w, contacts.links.radius.shape[0]]
    while slot < end:
        c = contact_force_at(contacts, slot, x, w)
        slide = wp.vec3(0.0)
        if c.normal_force > 0.0:
            slide = -(c.friction / (contacts.records.weight[slot] * contacts.law.friction_stiffness)) * c.slip
        contacts.records.slide[slot] = slide
        measured.force[slot] = c.normal_force * c.normal - c.friction * c.slip + contacts.records.owed[slot]
        slot += contacts.records.threads


@wp.kernel
def settle_debts(
    records: ContactRecords, measured: MeasuredContacts, link_force: wp.array[wp.vec3], debt: wp.array2d[wp.vec3]
):
    """Find what each link has had from the wall in this step and not given back: its debt. Launch (W, L).

    The links are moved first, against the wall where it was, and the wall then against the links where they are: while
    they move, the two forces differ by some percent. What is missing is paid whole in the next step, so that action and
    reaction are the same but for this delay. (Paid over more steps it comes later still; paid in advance, by what was
    missing in the last step, it sets links swinging that rest in a bend.) With no wall near it a link keeps its debt,
    less a tenth a step.

    Args:
        records: Contacts of the step.
        measured: Their forces on the wall at its end.
        link_force: Mean force of the wall on each link in it [N], shape (W*L,).
        debt: Impulse over the step that each link owes the wall [N], shape (W, L); updated.
    """
    w, link = wp.tid()
    begin = records.start[w, link]
    end = records.start[w, link + 1]
    rest = debt[w, link] - link_force[w * debt.shape[1] + link]
    for k in range(begin, end):
        rest -= measured.force[w * records.capacity + k]
    if begin == end:
        rest = 0.9 * rest
    debt[w, link] = rest


@wp.func
def vertex_contact_force(records: ContactRecords, measured: MeasuredContacts, i: int, w: int) -> wp.vec3:
    """Return the sum of the measured contacts on vertex ``i`` of world ``w`` [N]."""
    out = wp.vec3(0.0)
    entry = records.vertex_head[i, w]
    while entry >= 0:
        slot = entry // 4
        out += records.bary[slot][entry - 4 * slot] * measured.force[slot]
        entry = records.vertex_next[entry]
    return out


@wp.func
def add_self_contact(block: VertexBlock, self_contact: SelfContactForce, x: wp.vec3, i: int, w: int) -> VertexBlock:
    """Add the contact of the wall with itself on vertex ``i`` of world ``w`` at ``x``."""
    out = block
    k = self_contact.stiffness[i, w]
    if k > 0.0:
        plane = self_contact.plane[i, w]
        n = wp.vec3(plane[0], plane[1], plane[2])
        out.force += (plane[3] - k * wp.dot(n, x)) * n
        out.hessian += k * wp.outer(n, n)
    return out


@wp.func
def add_outer_force(block: VertexBlock, outer: OuterForce, x: wp.vec3, i: int, w: int) -> VertexBlock:
    """Add what the surroundings do to vertex ``i`` of world ``w`` at ``x``."""
    out = block
    if outer.near[outer.ring[i], w] == 1:
        out.force += outer_force(outer, x, i, w)
        out.hessian += outer.stiffness[i, w]
    return out


@wp.kernel
def predict(
    first: int,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    nodes: WallNodes,
    tissue: Tissue,
    decay: float,
    largest_speed: float,
    dt: float,
    x_prev: wp.array2d[wp.vec3],
    inertial: wp.array2d[wp.vec3],
):
    """Find where mobile vertices would go at their damped velocity. Launch (V, W), or some of the rows.

    Args:
        first: First row of this launch.
        x: Positions [m], shape (V, W).
        v: Velocities [m/s], shape (V, W).
        nodes: Vertices of all patients.
        tissue: Values of each world.
        decay: Factor on the velocity over the step.
        largest_speed: Speed at most [m/s].
        dt: Physics step [s].
        x_prev: The same positions [m], shape (V, W); written.
        inertial: Positions that inertia pulls to [m], shape (V, W); written.
    """
    i, w = wp.tid()
    i += first
    target = x[i, w]
    x_prev[i, w] = target
    if nodes.mobile[i, nodes.patient[w]] == 1 and tissue.rigid[w] == 0:
        target += dt * clamp_length(decay * v[i, w], largest_speed)
    inertial[i, w] = target


@wp.kernel
def finish(first: int, x: wp.array2d[wp.vec3], x_prev: wp.array2d[wp.vec3], dt: float, v: wp.array2d[wp.vec3]):
    """Write the velocity ``v`` [m/s] of a step from ``x_prev`` to ``x`` [m], shape (V, W) each, from row ``first`` on.

    Launch (V, W).
    """
    i, w = wp.tid()
    i += first
    v[i, w] = (x[i, w] - x_prev[i, w]) / dt
