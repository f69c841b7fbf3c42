# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Friction between rings of loops that touch, see ``self_contact_kernels``. V wall vertices, R rings, W worlds.

Two rings that push on each other by N are tied by a spring across their normal, k times the way q that their facing
sides have slid on each other, and no more than mu N: there the spring's end slides along. Either ring keeps its own
copy of q, which changes alike. Within a step the mean velocity of the two is taken to stay, and an own move against it
counts twice, for the other ring moves back as much: so they neither swing against each other nor hold each other where
they are.
"""

import warp as wp

from arcgym.sim.contact.self_contact_kernels import (
    MAX_OVERLAP,
    NO_CONTACT,
    RingSpheres,
    SelfContactForce,
    WallRings,
    facing_extent,
    facing_weight,
    pair_gap,
    pair_stiffness,
    rings_to_skip,
    xyz,
)
from arcgym.sim.wall.outer_force_kernels import OuterForce, put_outer_force
from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def facing_velocity(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    r: int,
    w: int,
    sphere: wp.vec4,
    n: wp.vec3,
) -> wp.vec3:
    """Return the mean velocity of the side ``n`` of ring ``r`` [m/s]."""
    total = wp.vec3(0.0)
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            total += facing_weight(x[i, w], sphere, n) * v[i, w]
    return total / facing_extent(rings, x, r, w, sphere, n)[1]


@wp.struct
class Ties:
    """What each ring has slid on the rings that it touches, K slots each."""

    partner: wp.array3d[int]  # one more than the other ring, 0 for a free slot, shape (R, K, W)
    slid: wp.array3d[wp.vec3]  # way that the spring holds [m], shape (R, K, W)
    stiffness: float  # of a spring [N/m]


@wp.func
def find_slot(ties: Ties, r: int, s: int, w: int) -> int:
    """Return the slot of ring ``r`` for ring ``s``, a free one if there is none yet, or -1."""
    found = int(-1)
    for k in range(ties.partner.shape[1]):
        partner = ties.partner[r, k, w]
        if partner == s + 1:
            return k
        if partner == 0 and found < 0:
            found = k
    return found


@wp.func
def slide_on(ties: Ties, r: int, s: int, w: int, way: wp.vec3, n: wp.vec3, limit: float) -> wp.vec4:
    """Let ring ``r`` slide on ring ``s`` by ``way`` [m] and return the spring's way [m], and 1 if it holds, else 0.

    Args:
        ties: Ties; the slot is written.
        r: Ring.
        s: The other.
        w: World.
        way: Of this step [m].
        n: Normal.
        limit: Longest way that friction holds [m].
    """
    slot = find_slot(ties, r, s, w)
    q = way
    if slot >= 0:
        if ties.partner[r, slot, w] == s + 1:
            q += ties.slid[r, slot, w]
        ties.partner[r, slot, w] = s + 1
    q = q - wp.dot(q, n) * n
    length = wp.length(q)
    holds = float(1.0)
    if length > limit:
        q = (limit / length) * q
        holds = 0.0
    if slot >= 0:
        ties.slid[r, slot, w] = q
    return wp.vec4(q[0], q[1], q[2], holds)


@wp.func
def drag_ring(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    r: int,
    w: int,
    own: wp.vec4,
    n: wp.vec3,
    force: wp.vec3,
    stiffness: float,
    outer: OuterForce,
):
    """Put ``force`` [N] on the side ``n`` of ring ``r``, with a ``stiffness`` [N/m] across ``n``."""
    across = stiffness * (wp.identity(n=3, dtype=float) - wp.outer(n, n))
    total = facing_extent(rings, x, r, w, own, n)[1]
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            share = facing_weight(x[i, w], own, n) / total
            put_outer_force(outer, i, w, x[i, w], share * force, share * across)
    outer.near[r, w] = 1


@wp.func
def rub_pair(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    r: int,
    s: int,
    w: int,
    own: wp.vec4,
    other: wp.vec4,
    n: wp.vec3,
    most: float,
    dt: float,
    ties: Ties,
    outer: OuterForce,
):
    """Drag ring ``r`` along ring ``s``, in the direction ``n``, by ``most`` [N] at most."""
    here = facing_velocity(rings, x, v, r, w, own, n)
    there = facing_velocity(rings, x, v, s, w, other, -n)
    tie = slide_on(ties, r, s, w, dt * (here - there), n, most / ties.stiffness)
    force = -ties.stiffness * xyz(tie)
    stiffness = 2.0 * ties.stiffness * tie[3]
    mean = 0.5 * (here + there)
    force += (stiffness * dt) * (mean - wp.dot(mean, n) * n)
    drag_ring(rings, x, r, w, own, n, force, stiffness, outer)


@wp.kernel
def rub_loops(
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    rings: WallRings,
    spheres: RingSpheres,
    contact: SelfContactForce,
    friction: wp.array[float],
    dt: float,
    ties: Ties,
    outer: OuterForce,
):
    """Drag each ring along those that it touches. Launch (R, W).

    Args:
        x: Wall positions [m], shape (V, W).
        v: Wall velocities, those of the last step [m/s], shape (V, W).
        rings: Rings of all patients.
        spheres: Their spheres at ``x``.
        contact: Contact measured there.
        friction: Coulomb coefficient, shape (W,).
        dt: Physics step [s].
        ties: What rings have slid; updated.
        outer: Forces; added to.
    """
    r, w = wp.tid()
    touched = int(0)  # bits of the slots of rings that still touch
    if contact.in_contact[r, w] == 1:
        own = spheres.sphere[r, w]
        s = int(0)
        while s < rings.members.shape[0]:
            other = spheres.sphere[s, w]
            offset = xyz(other) - xyz(own)
            d = wp.length(offset)
            least = rings.min_gap[r, s, rings.patient[w]]
            if d < own[3] + other[3] + rings.thickness and least > NO_CONTACT and d > 0.0:
                n = offset / d
                depth = least - pair_gap(rings, x, r, s, w, own, other, n)
                if depth > 0.0:
                    push = pair_stiffness(rings, spheres, r, s, w, d, depth) * wp.min(depth, MAX_OVERLAP)
                    rub_pair(rings, x, v, r, s, w, own, other, n, friction[w] * push, dt, ties, outer)
                    slot = find_slot(ties, r, s, w)
                    if slot >= 0:
                        touched = touched | (1 << slot)
            s += 1 + rings_to_skip(rings, own, d, w)
    for k in range(ties.partner.shape[1]):
        if (touched >> k) & 1 == 0:
            ties.partner[r, k, w] = 0
