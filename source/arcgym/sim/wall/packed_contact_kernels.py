# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contacts of a wall step on a GPU: what does not change within the step is looked up once, and kept side by side.

A contact is measured anew with each of its vertices that a sweep moves. Each time its record leads to corners and link,
and those to places and poses: a GPU waits for one after the other, longer than the whole rest of a vertex takes. What a
contact keeps through the step is 36 numbers, of which all can be asked for at once.

The slip of the wall's point p along the link is turn (p - center) + since, with the link's center, its turn back to
where it was when the step began, and the way from the wall's point to the center then.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import (
    ContactLaw,
    approach_damping,
    capsule_geometry,
    carried,
    normal_force,
    slide_stiffness,
    touched,
)
from arcgym.sim.wall.wall_kernels import ContactForce, MeasuredContacts, VertexBlock, WallContacts
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.four_store_kernels import joined, leading, load_four, store_four
from arcgym.utils.warp_setup import FAST

FOURS = 9
"""Vectors of four that a packed contact takes."""


@wp.struct
class PackedContact:
    """What a contact keeps through a wall step."""

    corners: wp.vec4i  # wall vertices that carry its point
    bary: wp.vec4  # their weights
    offset: wp.vec3  # from what they carry to the point [m]
    center: wp.vec3  # of the link [m]
    axis: wp.vec3  # half the link's [m]
    radius: float  # distance from the axis at which link and wall touch [m]
    share: float  # of a full contact
    wall_normal: wp.vec3  # see ``ContactRecords.normal``
    turn: wp.quat  # of the link from its end of the step back to its start
    since: wp.vec3  # from the wall's point to the link's center at the start of the step [m]
    held: wp.vec3  # elastic displacement that friction holds [m]
    owed: wp.vec3  # force on the wall that is owed [N]


@wp.func
def gathered_contact(contacts: WallContacts, x: wp.array2d[wp.vec3], slot: int, w: int) -> PackedContact:
    """Look up what is known of a contact before the scope has moved, at wall positions ``x``; the rest is zero."""
    records = contacts.records
    out = PackedContact()
    out.corners = records.corners[slot]
    out.bary = records.bary[slot]
    out.offset = records.offset[slot]
    out.wall_normal = records.normal[slot]
    before = contacts.body_q_prev[w * contacts.links.radius.shape[0] + records.link[slot]]
    out.since = wp.transform_get_translation(before) - touched(records, slot, x, w)
    out.held = records.slide[slot]
    out.owed = records.owed[slot]
    return out


@wp.func
def follow_link(c: PackedContact, contacts: WallContacts, slot: int, w: int) -> PackedContact:
    """Add to a contact where its link has gone."""
    out = c
    link = contacts.records.link[slot]
    row = w * contacts.links.radius.shape[0] + link
    pose = contacts.body_q[row]
    before = contacts.body_q_prev[row]
    out.center = wp.transform_get_translation(pose)
    out.axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, contacts.links.half_length[link]))
    out.radius = contacts.links.radius[link] + contacts.law.wall_radius
    out.share = contacts.records.weight[slot]
    out.turn = wp.transform_get_rotation(before) * wp.quat_inverse(wp.transform_get_rotation(pose))
    return out


@wp.func
def store_place(packed: wp.array[wp.vec4], slot: int, c: PackedContact):
    """Keep what is known of a contact before the scope has moved; ``packed`` has the shape (9*W*S,)."""
    at = wp.static(FOURS) * slot
    f = c.corners
    bits = wp.vec4(wp.cast(f[0], float), wp.cast(f[1], float), wp.cast(f[2], float), wp.cast(f[3], float))
    store_four(packed, at, bits)
    store_four(packed, at + 1, c.bary)
    store_four(packed, at + 4, joined(c.wall_normal, c.offset[0]))
    store_four(packed, at + 6, joined(c.since, c.offset[1]))
    store_four(packed, at + 7, joined(c.held, c.offset[2]))
    store_four(packed, at + 8, joined(c.owed, 0.0))


@wp.func
def store_link(packed: wp.array[wp.vec4], slot: int, c: PackedContact):
    """Keep where a contact's link has gone."""
    at = wp.static(FOURS) * slot
    store_four(packed, at + 2, joined(c.center, c.radius))
    store_four(packed, at + 3, joined(c.axis, c.share))
    store_four(packed, at + 5, wp.vec4(c.turn[0], c.turn[1], c.turn[2], c.turn[3]))


@wp.func
def load_contact(packed: wp.array[wp.vec4], slot: int) -> PackedContact:
    """Return a contact that was kept."""
    at = wp.static(FOURS) * slot
    bits = load_four(packed, at)
    bary = load_four(packed, at + 1)
    center = load_four(packed, at + 2)
    axis = load_four(packed, at + 3)
    normal = load_four(packed, at + 4)
    turn = load_four(packed, at + 5)
    since = load_four(packed, at + 6)
    held = load_four(packed, at + 7)
    out = PackedContact()
    out.owed = leading(load_four(packed, at + 8))
    out.corners = wp.vec4i(wp.cast(bits[0], int), wp.cast(bits[1], int), wp.cast(bits[2], int), wp.cast(bits[3], int))
    out.bary = bary
    out.center = leading(center)
    out.radius = center[3]
    out.axis = leading(axis)
    out.share = axis[3]
    out.wall_normal = leading(normal)
    out.turn = wp.quat(turn[0], turn[1], turn[2], turn[3])
    out.since = leading(since)
    out.held = leading(held)
    out.offset = wp.vec3(normal[3], since[3], held[3])
    return out


@wp.func
def packed_force(
    law: ContactLaw, dt: float, friction: float, c: PackedContact, x: wp.array2d[wp.vec3], w: int
) -> ContactForce:
    """Return the force of a contact at the positions ``x`` of world ``w``, as ``contact_force_at`` does."""
    out = ContactForce()
    p = carried(x, c.corners, c.bary, w)
    if c.corners[3] != c.corners[2]:
        p += c.offset
    geometry = capsule_geometry(p, c.wall_normal, c.center, c.axis, c.radius)
    if geometry.gap < 0.0:
        push = c.share * normal_force(law, -geometry.gap)
        out.normal_force = push[0]
        out.stiffness = push[1]
        out.normal = geometry.normal
        slip = wp.quat_rotate(c.turn, p - c.center) + c.since
        opening = wp.dot(out.normal, slip)
        if opening < 0.0:
            damping = c.share * approach_damping(law, -geometry.gap) / dt
            out.normal_force -= damping * opening
            out.stiffness += damping
        slip = slip - out.normal * opening
        out.slip = slip - c.held + wp.dot(out.normal, c.held) * out.normal
        speed = wp.length(slip) / dt
        out.friction = slide_stiffness(law, c.share, friction, out.normal_force, out.slip, speed)
    return out


@wp.func
def add_packed(block: VertexBlock, contacts: WallContacts, x: wp.array2d[wp.vec3], i: int, w: int) -> VertexBlock:
    """Add the contacts listed for vertex ``i`` of world ``w``, as ``add_contact`` does."""
    out = block
    eye = wp.identity(n=3, dtype=float)
    entry = contacts.records.vertex_head[i, w]
    while entry >= 0:
        following = contacts.records.vertex_next[entry]
        slot = entry / 4
        c = load_contact(contacts.packed, slot)
        k = entry - 4 * slot
        weight = wp.where(k < 2, wp.where(k == 0, c.bary[0], c.bary[1]), wp.where(k == 2, c.bary[2], c.bary[3]))
        f = packed_force(contacts.law, contacts.dt, contacts.friction[w], c, x, w)
        if f.normal_force > 0.0:
            along = wp.outer(f.normal, f.normal)
            out.force += weight * (f.normal_force * f.normal - f.friction * f.slip)
            out.hessian += (weight * weight) * (f.stiffness * along + f.friction * (eye - along))
        out.force += weight * c.owed
        entry = following
    return out


@wp.func
def write_measured(measured: MeasuredContacts, slot: int, c: PackedContact, f: ContactForce):
    """Write a contact's force, normal and stiffness."""
    measured.force[slot] = f.normal_force * f.normal - f.friction * f.slip + c.owed
    measured.normal[slot] = f.normal
    measured.stiffness[slot] = wp.vec2(f.stiffness, f.friction)


@wp.kernel(module_options=FAST, module="unique")
def pack_contacts(contacts: WallContacts, x: wp.array2d[wp.vec3]):
    """Look up what is known of every contact before the scope has moved. Launch (W, T).

    Args:
        contacts: Contacts of the step; ``packed`` is written. ``x_prev`` and ``body_q`` are not read.
        x: Wall positions at its start [m], shape (V, W).
    """
    w, thread = wp.tid()
    slot = w * contacts.records.capacity + thread
    end = w * contacts.records.capacity + contacts.records.start[w, contacts.links.radius.shape[0]]
    while slot < end:
        store_place(contacts.packed, slot, gathered_contact(contacts, x, slot, w))
        slot += contacts.records.threads


@wp.kernel(module_options=FAST, module="unique")
def measure_packed(contacts: WallContacts, x: wp.array2d[wp.vec3], measured: MeasuredContacts):
    """Measure every contact at wall positions ``x``, and keep where its link has gone. Launch (W, T).

    Args:
        contacts: Contacts of the step, of which ``pack_contacts`` has written its part; ``packed`` is written.
        x: Wall positions [m], shape (V, W).
        measured: ``force``, ``normal`` and ``stiffness`` are written.
    """
    w, thread = wp.tid()
    slot = w * contacts.records.capacity + thread
    end = w * contacts.records.capacity + contacts.records.start[w, contacts.links.radius.shape[0]]
    while slot < end:
        c = follow_link(load_contact(contacts.packed, slot), contacts, slot, w)
        store_link(contacts.packed, slot, c)
        write_measured(measured, slot, c, packed_force(contacts.law, contacts.dt, contacts.friction[w], c, x, w))
        slot += contacts.records.threads


@wp.kernel(module_options=FAST, module="unique")
def advance_packed(contacts: WallContacts, x: wp.array2d[wp.vec3], measured: MeasuredContacts):
    """Keep what friction holds of every contact, as ``advance_slides`` does. Launch (W, T).

    Args:
        contacts: Contacts of the step, packed.
        x: Wall positions at its end [m], shape (V, W).
        measured: ``force`` is written.
    """
    w, thread = wp.tid()
    slot = w * contacts.records.capacity + thread
    end = w * contacts.records.capacity + contacts.records.start[w, contacts.links.radius.shape[0]]
    while slot < end:
        c = load_contact(contacts.packed, slot)
        f = packed_force(contacts.law, contacts.dt, contacts.friction[w], c, x, w)
        slide = wp.vec3(0.0)
        if f.normal_force > 0.0:
            slide = -(f.friction / (c.share * contacts.law.friction_stiffness)) * f.slip
        contacts.records.slide[slot] = slide
        measured.force[slot] = f.normal_force * f.normal - f.friction * f.slip + c.owed
        slot += contacts.records.threads
