# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact loads on the links, implicit in their motion. W worlds, L links, V wall vertices a world.

A GPU whose warps solve the chains sums them up with :mod:`.link_load_block_kernels`.
"""

import warp as wp

from arcgym.sim.contact.contact_kernels import (
    CLEARANCE,
    ContactLaw,
    ContactRecords,
    LinkShapes,
    approach_damping,
    carried,
    contact_geometry,
    normal_force,
    slide_stiffness,
    touched,
)
from arcgym.sim.scope.scope_kernels import ArticulatedBody, LinkLoads, shift_origin
from arcgym.utils import warp_setup  # noqa: F401

SLOW = wp.constant(0.02)
"""Speed along the normal below which a contact keeps more of the damping that the step adds [m/s]: without it contacts
at rest tremble, and friction lets go."""


@wp.struct
class ContactPush:
    """Force of a link on the wall at one contact: ``force`` and inertia times the acceleration of the link's point."""

    force: wp.vec3  # if the point keeps its velocity [N]
    normal: wp.vec3  # from the scope into the wall
    along: float  # inertia along the normal [kg]
    across: float  # across it [kg]
    lever: wp.vec3  # from the link's center of mass to the point [m]


@wp.func
def contact_push(
    law: ContactLaw,
    share: float,
    friction: float,
    gap: float,
    normal: wp.vec3,
    lin: wp.vec3,
    wall_v: wp.vec3,
    slide: wp.vec3,
    dt: float,
) -> ContactPush:
    """Return what one contact does to a link, as function of the acceleration of its point.

    Springs and damper act with their values at the end of the step; the stiffness of the normal spring is a secant that
    keeps it from pulling.

    The velocity alone tells whether link and wall touch at the end of the step. Where they do not, but are within
    ``search_gap``, the contact's stiffness still resists acceleration, less the wider the gap: what presses on the link
    may bring it back within the step. Without, 30 N drove a light link that was rebounding from the wall 15 mm through
    it in one step. A steady motion is as it was.

    A spring at its place at the end of the step damps as a damper of ``dt`` times its stiffness would. ``law.relief``
    of that is taken off by counting the depth, for this share, as it is at the beginning, and less of it where link
    and wall are slower than ``SLOW``; against acceleration the contact stays as stiff.

    Args:
        law: Contact law.
        share: Weight of the contact.
        friction: Coulomb coefficient, dynamic.
        gap: Distance of the surfaces, negative where they overlap [m].
        normal: Unit vector from the scope into the wall.
        lin: Velocity of the link's point [m/s].
        wall_v: Velocity of the wall's point [m/s].
        slide: How far the link has come along the wall so far: what friction holds, and the way in this step [m].
        dt: Substep [s].

    """
    out = ContactPush()
    out.normal = normal
    end = gap - dt * wp.dot(normal, lin)
    if end < 0.0:
        relative = lin - wall_v
        approach = wp.dot(normal, relative)
        damping = float(0.0)
        if approach > 0.0:
            damping = share * approach_damping(law, -end)
        slip = relative - approach * normal
        now = share * normal_force(law, wp.max(-gap, 0.0))
        end_slide = slide - wp.dot(normal, slide) * normal + dt * slip
        hold = slide_stiffness(law, share, friction, now[0], end_slide, wp.length(slip))
        push = share * normal_force(law, -end)
        stiffness = wp.max(-push[0] / end, 0.5 * push[1])
        out.force = (damping * approach + push[0]) * normal + hold * end_slide
        if law.relief > 0.0:
            relief = law.relief * wp.min(wp.abs(wp.dot(normal, lin)) / SLOW, 1.0)
            depth = relief * (-gap) + (1.0 - relief) * (-end)
            early = share * normal_force(law, wp.max(depth, 0.0))
            out.force = (damping * approach + early[0]) * normal + hold * end_slide
        out.along = dt * (damping + dt * stiffness)
        out.across = dt * dt * hold
    elif gap < law.search_gap:
        resting = share * normal_force(law, wp.max(-gap, 1.0e-6))
        stiffness = wp.max(resting[0] / wp.max(-gap, 1.0e-6), 0.5 * resting[1])
        out.along = dt * dt * stiffness * (1.0 - wp.max(gap, 0.0) / law.search_gap)
    return out


@wp.func
def load_of(push: ContactPush) -> ArticulatedBody:
    """Return a contact as a load at its point."""
    along = wp.outer(push.normal, push.normal)
    across = wp.identity(n=3, dtype=float) - along
    out = ArticulatedBody()
    out.ll = push.along * along + push.across * across
    out.force = push.force
    return out


@wp.struct
class MovingLink:
    """Where a link is and how it moves."""

    pose: wp.transform
    center: wp.vec3  # of mass [m]
    velocity: wp.spatial_vector  # [m/s, rad/s]
    back: wp.transform  # takes a point of the link to where it was at the start of the physics step


@wp.func
def push_at(
    slot: int,
    link: int,
    w: int,
    motion: MovingLink,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    links: LinkShapes,
    records: ContactRecords,
    law: ContactLaw,
    friction: wp.array[float],
    elapsed: float,
    dt: float,
    penetrated: wp.array[int],
) -> ContactPush:
    """Return what the contact in ``slot`` does to its link; see :func:`load_contacts`."""
    if elapsed == 0.0:
        records.point[slot] = touched(records, slot, x, w)
        records.point_vel[slot] = carried(v, records.corners[slot], records.bary[slot], w)
    p = records.point[slot]
    wall_v = records.point_vel[slot]
    radius = links.radius[link] + law.wall_radius
    c = contact_geometry(p, records.normal[slot], motion.pose, links.half_length[link], radius)
    if c.gap + radius < CLEARANCE * links.radius[link]:
        penetrated[w] = 1
    lin = wp.spatial_top(motion.velocity) + wp.cross(wp.spatial_bottom(motion.velocity), p - motion.center)
    slide = records.slide[slot] + p - wp.transform_point(motion.back, p) - elapsed * wall_v
    out = contact_push(law, records.weight[slot], friction[w], c.gap, c.normal, lin, wall_v, slide, dt)
    out.lever = p - motion.center
    return out


@wp.func
def link_motion(
    row: int,
    link: int,
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    com: wp.array[wp.vec3],
    body_q_prev: wp.array[wp.transform],
) -> MovingLink:
    """Return the motion of the link in ``row``; see :func:`load_contacts`."""
    out = MovingLink()
    out.pose = body_q[row]
    out.center = wp.transform_point(out.pose, com[link])
    out.velocity = body_qd[row]
    out.back = body_q_prev[row] * wp.transform_inverse(out.pose)
    return out


@wp.func
def summed(total: ArticulatedBody, one: ArticulatedBody) -> ArticulatedBody:
    """Return the sum of two loads at the same point."""
    out = total
    out.ll += one.ll
    out.la += one.la
    out.aa += one.aa
    out.force += one.force
    out.torque += one.torque
    return out


@wp.func
def write_load(link: int, w: int, total: ArticulatedBody, loads: LinkLoads):
    """Write the sum of a link's contacts."""
    loads.ll[link, w] = total.ll
    loads.la[link, w] = total.la
    loads.aa[link, w] = total.aa
    loads.wrench[link, w] = wp.spatial_vector(-total.force, -total.torque)


@wp.kernel
def load_contacts(
    body_q: wp.array[wp.transform],
    body_qd: wp.array[wp.spatial_vector],
    com: wp.array[wp.vec3],
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    links: LinkShapes,
    records: ContactRecords,
    law: ContactLaw,
    friction: wp.array[float],
    body_q_prev: wp.array[wp.transform],
    elapsed: float,
    dt: float,
    loads: LinkLoads,
    penetrated: wp.array[int],
):
    """Sum up the contacts of each link with the wall at its present place. Launch (L, W).

    Args:
        body_q: Link poses, shape (W*L,).
        body_qd: Link velocities [m/s, rad/s], shape (W*L,).
        com: Centers of mass in the links' frames [m], shape (W*L,).
        x: Wall positions [m], shape (V, W).
        v: Wall velocities [m/s], shape (V, W).
        links: Capsules of one world.
        records: Contacts; ``point`` and ``point_vel`` are written where ``elapsed`` is 0, and read in later substeps.
        law: Contact law.
        friction: Coulomb coefficient of each world, shape (W,).
        body_q_prev: Link poses at the start of the physics step, shape (W*L,).
        elapsed: Time since then [s].
        dt: Substep [s].
        loads: Loads of the links; written.
        penetrated: Set to 1 where a link's axis is so close to the wall that it may get behind it, or is, shape (W,).
    """
    link, w = wp.tid()
    motion = link_motion(w * loads.wrench.shape[0] + link, link, body_q, body_qd, com, body_q_prev)
    total = ArticulatedBody()
    for k in range(records.start[w, link], records.start[w, link + 1]):
        slot = w * records.capacity + k
        one = push_at(slot, link, w, motion, x, v, links, records, law, friction, elapsed, dt, penetrated)
        total = summed(total, shift_origin(load_of(one), one.lever))
    write_load(link, w, total, loads)
