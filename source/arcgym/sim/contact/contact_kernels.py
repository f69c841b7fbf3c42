# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact law between capsule links and the inner wall: records, gap and normal, normal force, friction.

W worlds, L links a world, R rings (centerline bins), V wall vertices.
"""

import warp as wp

from arcgym.sim.geometry_kernels import segment_parameter
from arcgym.utils import warp_setup  # noqa: F401

BEHIND_COSINE = wp.constant(-0.5)
"""Cosine between the direction from axis to wall and the wall's normal, under which the axis is behind the wall."""
MAX_HARDENING = wp.constant(3.0)
"""Depth beyond which a contact does not harden any more, in multiples of its hardening depth."""
SQUEEZED = wp.constant(1.5)
"""Depth beyond which a contact hardens further, in the same multiples: 3 mm, the thickness of the thicker wall. Tissue
is not squeezed by more than that."""
FURTHER = wp.constant(8.0)
"""Factor of the further hardening, which makes a contact 28 times as hard as a shallow one, instead of 10."""
CLEARANCE = wp.constant(0.25)
"""Share of its radius by which a link's axis must stay off the wall to count as inside."""
BEHIND_REACH = wp.constant(0.5)
"""Share of its radius up to which a link can be behind a face that it went through; a face behind which it is farther
away is another side of a fold. Twice ``CLEARANCE``: a link that close to the wall is behind the faces around it at no
more than that, where they meet its axis at the angle of ``BEHIND_COSINE``."""


@wp.struct
class LinkShapes:
    """Capsules of one world's links, axis along the link's local Z."""

    half_length: wp.array[float]  # [m], shape (L,)
    radius: wp.array[float]  # [m], shape (L,)


@wp.struct
class ContactRecords:
    """Contacts of every link, one for each face near it, in a pool of S slots a world, by link.

    Everything about a contact is a continuous function of where link and wall are, so that nothing flutters.
    """

    capacity: int  # slots of a world, S
    threads: int  # threads a world, T, of a kernel that goes through all records: each takes every T-th
    start: wp.array2d[int]  # first slot of each link among its world's, and of none after the last, shape (W, L + 1)
    link: wp.array[int]  # link of each slot, shape (W*S,)
    face: wp.array[int]  # in ascending order for each link, shape (W*S,)
    ring: wp.array[int]  # lowest ring of the face's vertices
    corners: wp.array[wp.vec4i]  # wall vertices that carry the point; of a wall's face, the last one twice
    bary: wp.array[wp.vec4]  # their weights, of sum 1; of a wall's face, barycentric coordinates and 0
    offset: wp.array[wp.vec3]  # from the point that they carry to the one that is touched; 0 on the wall itself [m]
    point: wp.array[wp.vec3]  # the point that is touched, where the wall is while the scope moves [m]
    point_vel: wp.array[wp.vec3]  # velocity of the wall there [m/s]
    distance: wp.array[float]  # of the link's axis from the face [m]
    weight: wp.array[float]  # share of the contact stiffness
    normal: wp.array[wp.vec3]  # outward normal of the wall there at detection, or direction from a link clear of it
    slide: wp.array[wp.vec3]  # elastic displacement of the link along the wall, which friction bounds [m]
    owed: wp.array[wp.vec3]  # part of the force on the wall that is still owed from earlier steps [N]
    vertex_head: wp.array2d[int]  # first entry of each vertex's list, shape (V, W); entry e = 4 * record + corner
    vertex_next: wp.array[int]  # shape (4*W*S,)
    ring_head: wp.array2d[int]  # first record whose lowest ring is this one, shape (R, W)
    ring_next: wp.array[int]  # shape (W*S,)
    dropped: wp.array[int]  # contacts that found no slot since the start, shape (W,)


@wp.struct
class ContactLaw:
    """Penalty contact with Coulomb friction that holds elastically until it slides."""

    stiffness: float  # of a shallow contact inside a face on a hard wall, the largest [N/m]
    tissue_share: float  # of it on a soft shell, over E t / (1 - nu^2); 0 where the wall itself is squeezed
    hardening: float  # depth at which the stiffness has doubled, as a secant [m]
    damping: float  # [N s/m], approach only
    deep_damping: float  # added to it, in full at twice the depth ``hardening`` and none up to it [N s/m]
    relief: float  # share taken off the damping that the step adds
    friction_stiffness: float  # across the wall, of a contact that sticks [N/m]
    static_friction: float  # static over dynamic friction
    slip_velocity: float  # speed at which friction has fallen to 1/e of the way from static to dynamic [m/s]
    wall_radius: float  # half the skin that the wall adds to each link [m]
    search_gap: float  # distance up to which records are kept [m]


@wp.func
def carried(x: wp.array2d[wp.vec3], corners: wp.vec4i, weights: wp.vec4, w: int) -> wp.vec3:
    """Return the mean of world ``w``'s vertices ``corners`` by their weights; ``x`` has shape (V, W)."""
    out = weights[0] * x[corners[0], w] + weights[1] * x[corners[1], w] + weights[2] * x[corners[2], w]
    if corners[3] != corners[2]:
        out += weights[3] * x[corners[3], w]
    return out


@wp.func
def touched(records: ContactRecords, slot: int, x: wp.array2d[wp.vec3], w: int) -> wp.vec3:
    """Return the point of the wall that the contact in ``slot`` touches at the positions ``x`` of world ``w`` [m]."""
    corners = records.corners[slot]
    out = carried(x, corners, records.bary[slot], w)
    if corners[3] != corners[2]:
        out += records.offset[slot]
    return out


@wp.func
def normal_force(law: ContactLaw, depth: float) -> wp.vec2:
    """Return normal force [N] and stiffness [N/m] of a contact of weight 1 at depth d > 0.

    The force is k d (1 + s^2 + 8 max(s - 1.5, 0)^2) with s = min(d / h, 3).
    """
    hard = wp.min(depth / law.hardening, MAX_HARDENING)
    beyond = wp.max(hard - SQUEEZED, 0.0)
    secant = 1.0 + hard * hard + FURTHER * beyond * beyond
    if hard >= MAX_HARDENING:
        return law.stiffness * wp.vec2(depth * secant, secant)
    return law.stiffness * wp.vec2(depth * secant, secant + 2.0 * hard * (hard + FURTHER * beyond))


@wp.func
def approach_damping(law: ContactLaw, depth: float) -> float:
    """Return the damping of a contact of weight 1 at a depth [m] while link and wall approach [N s/m].

    Where the law hardens, a link and the wall that take turns throw each other to and fro, more in every step.
    """
    return law.damping + law.deep_damping * wp.clamp(depth / law.hardening - 1.0, 0.0, 1.0)


@wp.func
def softness(law: ContactLaw, moduli: wp.vec3) -> float:
    """Return the stiffness of a contact with a shell over ``law.stiffness``, at most 1.

    Args:
        law: Contact law.
        moduli: Of the shell: mu t [N/m], lambda t of plane stress [N/m]; E t / (1 - nu^2) is lambda t + 2 mu t.
    """
    if law.tissue_share == 0.0:
        return 1.0
    return wp.min(law.tissue_share * (moduli[1] + 2.0 * moduli[0]) / law.stiffness, 1.0)


@wp.struct
class ContactGeometry:
    """Gap and normal of one contact."""

    gap: float  # between the surfaces of link and wall, negative where they overlap [m]
    normal: wp.vec3  # unit vector from the scope into the wall


@wp.func
def capsule_geometry(
    p: wp.vec3, wall_normal: wp.vec3, center: wp.vec3, axis: wp.vec3, radius: float
) -> ContactGeometry:
    """Return what :func:`contact_geometry` does, for a capsule at ``center`` with half its axis ``axis`` [m]."""
    t = segment_parameter(p, center - axis, center + axis)
    r = p - center - (2.0 * t - 1.0) * axis
    d = wp.length(r)
    out = ContactGeometry()
    out.normal = wall_normal
    if d > 1.0e-6:
        out.normal = r / d
    if wp.dot(out.normal, wall_normal) < BEHIND_COSINE:
        out.normal = -out.normal
        d = -d
    out.gap = d - radius
    return out


@wp.func
def contact_geometry(
    p: wp.vec3, wall_normal: wp.vec3, pose: wp.transform, half_length: float, radius: float
) -> ContactGeometry:
    """Return the signed gap between wall point ``p`` and a capsule, and its normal.

    A point on the lumen side of the axis, judged by the wall's own normal, counts as behind it: the gap is then
    negative however far the link has gone through, so that a link is always pushed back inside.
    """
    center = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, half_length))
    return capsule_geometry(p, wall_normal, center, axis, radius)


@wp.func
def slide_stiffness(
    law: ContactLaw, share: float, friction: float, normal: float, slide: wp.vec3, speed: float
) -> float:
    """Return the secant stiffness [N/m] with which friction resists the displacement ``slide`` along the wall [m].

    Friction is a spring that slides on where it would pull harder than Coulomb's limit (Cundall and Strack 1979, "A
    discrete numerical model for granular assemblies"): it holds without creep. The limit falls from static to dynamic
    friction with the speed of the slip (Stribeck).

    Args:
        law: Contact law.
        share: Share of a full contact.
        friction: Coulomb coefficient, dynamic.
        normal: Normal force [N].
        slide: Displacement of the link along the wall, elastic part and that of this step [m].
        speed: Speed of the slip [m/s].
    """
    ratio = speed / law.slip_velocity
    limit = friction * normal * (1.0 + (law.static_friction - 1.0) * wp.exp(-ratio * ratio))
    return wp.min(share * law.friction_stiffness, limit / wp.max(wp.length(slide), 1.0e-12))
