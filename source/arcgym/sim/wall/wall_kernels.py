# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What the walls of both kinds share: vertices with mass and anchor, contact, the start and the end of a step.

W worlds, V wall vertices; arrays of vertices have the shape (V, W), so that neighbouring GPU threads, which work on
neighbouring worlds, read neighbouring memory.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactLaw, ContactRecords, LinkShapes, contact_push, slip_scale, touch
from arcgym.sim.contact.self_contact_kernels import LoopPress
from arcgym.sim.geometry_kernels import corner_point
from arcgym.sim.wall.anchor_kernels import Anchors, anchor_hessian, anchor_pull
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class WallNodes:
    """Vertices of one world's wall, shared by all worlds."""

    mass: wp.array(dtype=float)  # [kg], shape (V,)
    mobile: wp.array(dtype=int)  # 1 where the vertex moves, shape (V,)
    anchors: Anchors


@wp.struct
class Tissue:
    """What may differ from world to world."""

    moduli: wp.array(dtype=wp.vec3)  # shear, second Lame parameter, bending: solid [Pa, Pa, -], shell [N/m, N/m, N m]
    anchor: wp.array(dtype=float)  # factor on the anchor springs, shape (W,)
    rigid: wp.array(dtype=int)  # 1 where the whole wall stays where it is, shape (W,)


@wp.struct
class VertexBlock:
    """Force [N] on one vertex and the positive definite part of its Hessian [N/m]."""

    force: wp.vec3
    hessian: wp.mat33


QUIET_FORCE = wp.constant(1.0e-3)
"""Force under which a vertex that the ring correction has left alone is not swept [N]: noise of single precision."""
QUIET_MOVE = wp.constant(1.0e-7)
"""Move by the ring correction under which it counts as left alone [m]."""


@wp.func
def quiet(force: wp.vec3, moved: wp.vec3) -> bool:
    """Whether a vertex with this force and this move by the ring correction needs no sweep."""
    return wp.length_sq(force) < QUIET_FORCE * QUIET_FORCE and wp.length_sq(moved) < QUIET_MOVE * QUIET_MOVE


@wp.func
def inertia_and_anchor(
    nodes: WallNodes, tissue: Tissue, inertial: wp.vec3, x: wp.vec3, i: int, w: int, inv_dt2: float
) -> VertexBlock:
    """Block of the vertex's inertia and of its spring to the rest position."""
    inertia = nodes.mass[i] * inv_dt2
    scale = tissue.anchor[w]
    block = VertexBlock()
    block.force = inertia * (inertial - x) + scale * anchor_pull(nodes.anchors, i, x)
    block.hessian = inertia * wp.identity(n=3, dtype=float) + scale * anchor_hessian(nodes.anchors, i, x)
    return block


@wp.struct
class WallContacts:
    """Contacts of one wall step, and how the links and the wall have moved in it."""

    records: ContactRecords
    links: LinkShapes
    law: ContactLaw
    loops: LoopPress
    friction: wp.array(dtype=float)  # Coulomb coefficient, shape (W,)
    dt: float  # physics step [s]
    x_prev: wp.array2d(dtype=wp.vec3)  # wall positions at the start of the step [m], shape (V, W)
    body_q: wp.array(dtype=wp.transform)  # link poses at its end, shape (W*L,)
    body_q_prev: wp.array(dtype=wp.transform)  # and at its start, shape (W*L,)


@wp.struct
class Press:
    """One contact as the wall feels it.

    Normal force [N] and its stiffness [N/m], friction's secant stiffness [N/m], slip in this step [m].
    """

    push: float
    stiffness: float
    drag: float
    normal: wp.vec3
    slip: wp.vec3


@wp.func
def press_of(contacts: WallContacts, slot: int, x: wp.array2d(dtype=wp.vec3), w: int) -> Press:
    """Contact in ``slot`` of world ``w`` at wall positions ``x``; both forces are zero where nothing touches."""
    out = Press()
    row = slot // contacts.records.capacity
    link = row % contacts.links.radius.shape[0]
    f = contacts.records.corners[slot]
    u = contacts.records.bary[slot]
    p = corner_point(x, f, u, w)
    radius = contacts.links.radius[link] + contacts.law.wall_radius
    c = touch(p, contacts.records.normal[slot], contacts.body_q[row], contacts.links.half_length[link], radius)
    if c.gap < 0.0:
        share = contacts.records.weight[slot]
        push = share * contact_push(contacts.law, -c.gap)
        out.push = push[0]
        out.stiffness = push[1]
        out.normal = c.normal
        local = wp.transform_point(wp.transform_inverse(contacts.body_q[row]), p)
        slip = wp.transform_point(contacts.body_q_prev[row], local) - corner_point(contacts.x_prev, f, u, w)
        opening = wp.dot(c.normal, slip)
        if opening < 0.0:
            damping = share * contacts.law.damping / contacts.dt
            out.push -= damping * opening
            out.stiffness += damping
        out.slip = slip - c.normal * opening
        limit = contacts.law.slip_velocity * contacts.dt
        out.drag = contacts.friction[w] * out.push * slip_scale(wp.length(out.slip), limit)
    return out


@wp.func
def add_contact(
    block: VertexBlock, contacts: WallContacts, x: wp.array2d(dtype=wp.vec3), i: int, w: int
) -> VertexBlock:
    """Add the contacts listed for vertex ``i`` of world ``w``; friction works on the slip of this step."""
    out = block
    eye = wp.identity(n=3, dtype=float)
    entry = contacts.records.vertex_head[i, w]
    while entry >= 0:
        slot = entry // 3
        weight = contacts.records.bary[slot][entry - 3 * slot]
        c = press_of(contacts, slot, x, w)
        if c.push > 0.0:
            along = wp.outer(c.normal, c.normal)
            out.force += weight * (c.push * c.normal - c.drag * c.slip)
            out.hessian += (weight * weight) * (c.stiffness * along + c.drag * (eye - along))
        entry = contacts.records.vertex_next[entry]
    return out


@wp.struct
class Pressing:
    """Contacts measured at the start of a wall solve, by record slot; zero where nothing touches."""

    force: wp.array(dtype=wp.vec3)  # on the wall [N]
    normal: wp.array(dtype=wp.vec3)  # from the scope into the wall
    stiffness: wp.array(dtype=wp.vec2)  # along the normal and across it [N/m]


@wp.kernel
def measure_contacts(contacts: WallContacts, x: wp.array2d(dtype=wp.vec3), pressing: Pressing):
    """Measure every contact at wall positions ``x``. Launch (L, W)."""
    link, w = wp.tid()
    row = w * contacts.links.radius.shape[0] + link
    for k in range(contacts.records.count[row]):
        slot = row * contacts.records.capacity + k
        c = press_of(contacts, slot, x, w)
        pressing.force[slot] = c.push * c.normal - c.drag * c.slip
        pressing.normal[slot] = c.normal
        pressing.stiffness[slot] = wp.vec2(c.stiffness, c.drag)


@wp.func
def contact_force(records: ContactRecords, pressing: Pressing, i: int, w: int) -> wp.vec3:
    """Sum of the measured contacts on vertex ``i`` of world ``w`` [N]."""
    out = wp.vec3(0.0)
    entry = records.vertex_head[i, w]
    while entry >= 0:
        slot = entry // 3
        out += records.bary[slot][entry - 3 * slot] * pressing.force[slot]
        entry = records.vertex_next[entry]
    return out


@wp.func
def add_loops(block: VertexBlock, loops: LoopPress, x: wp.vec3, i: int, w: int) -> VertexBlock:
    """Add the push of other loops of the colon on vertex ``i`` of world ``w`` at ``x``."""
    out = block
    k = loops.stiffness[i, w]
    if k > 0.0:
        plane = loops.plane[i, w]
        n = wp.vec3(plane[0], plane[1], plane[2])
        out.force += (plane[3] - k * wp.dot(n, x)) * n
        out.hessian += k * wp.outer(n, n)
    return out


@wp.kernel
def predict(
    x: wp.array2d(dtype=wp.vec3),
    v: wp.array2d(dtype=wp.vec3),
    nodes: WallNodes,
    tissue: Tissue,
    decay: float,
    dt: float,
    x_prev: wp.array2d(dtype=wp.vec3),
    inertial: wp.array2d(dtype=wp.vec3),
):
    """Move mobile vertices on at their damped velocity; the result is also the inertial target. Launch (V, W)."""
    i, w = wp.tid()
    target = x[i, w]
    x_prev[i, w] = target
    if nodes.mobile[i] == 1 and tissue.rigid[w] == 0:
        target += decay * dt * v[i, w]
    inertial[i, w] = target
    x[i, w] = target


@wp.kernel
def finish(x_prev: wp.array2d(dtype=wp.vec3), dt: float, x: wp.array2d(dtype=wp.vec3), v: wp.array2d(dtype=wp.vec3)):
    """Velocity of the step. Launch (V, W)."""
    i, w = wp.tid()
    v[i, w] = (x[i, w] - x_prev[i, w]) / dt
