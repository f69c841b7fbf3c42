# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact of the wall with itself on a GPU, and friction there, by a group of threads a ring.

What ``self_contact_kernels`` and ``loop_friction_kernels`` do goes through the vertices of two rings again and again,
each of which a thread waits for. Here the threads of a group share them out. All of a group go the same way: what they
decide by is their sum.
"""

import warp as wp

from arcgym.sim.contact.loop_friction_kernels import Ties, find_slot, slide_on
from arcgym.sim.contact.self_contact_kernels import (
    MAX_OVERLAP,
    MIN_FORCE,
    NO_CONTACT,
    RingSpheres,
    SelfContactForce,
    WallRings,
    facing_weight,
    pair_stiffness,
    rings_to_skip,
    xyz,
)
from arcgym.sim.wall.outer_force_kernels import OuterForce, put_outer_force
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_vote_kernels import sum_of_group


@wp.func
def facing_extent_of_group(
    rings: WallRings, x: wp.array2d[wp.vec3], r: int, w: int, sphere: wp.vec4, n: wp.vec3, lane: int, lanes: int
) -> wp.vec2:
    """Do as ``facing_extent``."""
    sums = wp.vec3(0.0)
    k = int(lane)
    while k < rings.members.shape[1]:
        i = rings.members[r, k]
        if i >= 0:
            share = facing_weight(x[i, w], sphere, n)
            sums += wp.vec3(share * wp.dot(x[i, w] - xyz(sphere), n), share, 0.0)
        k += lanes
    sums = sum_of_group(sums)
    total = sums[1] + 1.0e-12
    return wp.vec2(sums[0] / total, total)


@wp.func
def facing_velocity_of_group(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    r: int,
    w: int,
    sphere: wp.vec4,
    n: wp.vec3,
    total: float,
    lane: int,
    lanes: int,
) -> wp.vec3:
    """Do as ``facing_velocity``, given the ``total`` of the weights."""
    sums = wp.vec3(0.0)
    k = int(lane)
    while k < rings.members.shape[1]:
        i = rings.members[r, k]
        if i >= 0:
            sums += facing_weight(x[i, w], sphere, n) * v[i, w]
        k += lanes
    return sum_of_group(sums) / total


@wp.struct
class RingPair:
    """Two rings whose spheres meet."""

    normal: wp.vec3  # from the one to the other
    apart: float  # distance of their centers [m]
    depth: float  # overlap of their outer surfaces, negative for none [m]
    own_total: float  # sum of the weights of the one's vertices, and of the other's
    other_total: float


@wp.func
def measure_pair(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    r: int,
    s: int,
    w: int,
    own: wp.vec4,
    other: wp.vec4,
    least: float,
    lane: int,
    lanes: int,
) -> RingPair:
    """Measure how far rings ``r`` and ``s`` overlap beyond the gap ``least``."""
    out = RingPair()
    offset = xyz(other) - xyz(own)
    out.apart = wp.length(offset)
    out.normal = offset / out.apart
    one = facing_extent_of_group(rings, x, r, w, own, out.normal, lane, lanes)
    two = facing_extent_of_group(rings, x, s, w, other, -out.normal, lane, lanes)
    out.depth = least - (out.apart - (one[0] + two[0]) - rings.thickness)
    out.own_total = one[1]
    out.other_total = two[1]
    return out


@wp.kernel(module="unique")
def measure_self_contact_in_groups(
    x: wp.array2d[wp.vec3], rings: WallRings, spheres: RingSpheres, lanes: int, out: SelfContactForce
):
    """Do as ``measure_self_contact``. Launch (R, W, lanes): ``GROUP`` on a GPU, on a CPU 1."""
    r, w, lane = wp.tid()
    if spheres.near[r, w] == 0 and out.in_contact[r, w] == 0:
        return
    own = spheres.sphere[r, w]
    in_contact = int(0)
    s = int(0)
    while s < rings.members.shape[0]:
        other = spheres.sphere[s, w]
        d = wp.length(xyz(other) - xyz(own))
        least = rings.min_gap[r, s, rings.patient[w]]
        if d < own[3] + other[3] + rings.thickness and least > NO_CONTACT and d > 0.0:
            pair = measure_pair(rings, x, r, s, w, own, other, least, lane, lanes)
            if pair.depth > 0.0:
                stiffness = pair_stiffness(rings, spheres, r, s, w, d, pair.depth)
                push = stiffness * wp.min(pair.depth, MAX_OVERLAP)
                k = int(lane)
                while k < rings.members.shape[1]:
                    i = rings.members[r, k]
                    if i >= 0:
                        share = facing_weight(x[i, w], own, pair.normal) / pair.own_total
                        force = (-share * push) * pair.normal
                        plane = wp.vec4(force[0], force[1], force[2], 0.0)
                        hold = 2.0 * share * stiffness
                        if in_contact == 1:
                            plane += out.plane[i, w]
                            hold += out.stiffness[i, w]
                        out.plane[i, w] = plane
                        out.stiffness[i, w] = hold
                    k += lanes
                in_contact = 1
        s += 1 + rings_to_skip(rings, own, d, w)
    finish_ring_of_group(rings, x, r, w, in_contact, lane, lanes, out)
    sum_of_group(wp.vec3(0.0))  # all of the group have read the mark
    if lane == 0:
        out.in_contact[r, w] = in_contact


@wp.func
def finish_ring_of_group(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    r: int,
    w: int,
    in_contact: int,
    lane: int,
    lanes: int,
    out: SelfContactForce,
):
    """Do as ``finish_ring``."""
    k = int(lane)
    while k < rings.members.shape[1]:
        i = rings.members[r, k]
        if i >= 0:
            force = xyz(out.plane[i, w])
            size = wp.length(force)
            if in_contact == 1 and size > MIN_FORCE:
                n = force / size
                c = size + out.stiffness[i, w] * wp.dot(n, x[i, w])
                out.plane[i, w] = wp.vec4(n[0], n[1], n[2], c)
            else:
                out.stiffness[i, w] = 0.0
        k += lanes


@wp.kernel(module="unique")
def rub_loops_in_groups(
    x: wp.array2d[wp.vec3],
    v: wp.array2d[wp.vec3],
    rings: WallRings,
    spheres: RingSpheres,
    contact: SelfContactForce,
    friction: wp.array[float],
    dt: float,
    lanes: int,
    ties: Ties,
    outer: OuterForce,
):
    """Do as ``rub_loops``. Launch (R, W, lanes): ``GROUP`` on a GPU, on a CPU 1."""
    r, w, lane = wp.tid()
    touched = int(0)  # bits of the slots of rings that still touch, known to the first of the group
    if contact.in_contact[r, w] == 1:
        own = spheres.sphere[r, w]
        s = int(0)
        while s < rings.members.shape[0]:
            other = spheres.sphere[s, w]
            d = wp.length(xyz(other) - xyz(own))
            least = rings.min_gap[r, s, rings.patient[w]]
            if d < own[3] + other[3] + rings.thickness and least > NO_CONTACT and d > 0.0:
                pair = measure_pair(rings, x, r, s, w, own, other, least, lane, lanes)
                if pair.depth > 0.0:
                    n = pair.normal
                    push = pair_stiffness(rings, spheres, r, s, w, d, pair.depth) * wp.min(pair.depth, MAX_OVERLAP)
                    here = facing_velocity_of_group(rings, x, v, r, w, own, n, pair.own_total, lane, lanes)
                    there = facing_velocity_of_group(rings, x, v, s, w, other, -n, pair.other_total, lane, lanes)
                    tie = wp.vec4(0.0)
                    if lane == 0:
                        tie = slide_on(ties, r, s, w, dt * (here - there), n, friction[w] * push / ties.stiffness)
                        slot = find_slot(ties, r, s, w)
                        if slot >= 0:
                            touched = touched | (1 << slot)
                    way = sum_of_group(xyz(tie))
                    holds = sum_of_group(wp.vec3(tie[3], 0.0, 0.0))
                    stiffness = 2.0 * ties.stiffness * holds[0]
                    mean = 0.5 * (here + there)
                    force = -ties.stiffness * way + (stiffness * dt) * (mean - wp.dot(mean, n) * n)
                    across = stiffness * (wp.identity(n=3, dtype=float) - wp.outer(n, n))
                    k = int(lane)
                    while k < rings.members.shape[1]:
                        i = rings.members[r, k]
                        if i >= 0:
                            share = facing_weight(x[i, w], own, n) / pair.own_total
                            put_outer_force(outer, i, w, x[i, w], share * force, share * across)
                        k += lanes
                    outer.near[r, w] = 1
            s += 1 + rings_to_skip(rings, own, d, w)
    if lane == 0:
        for k in range(ties.partner.shape[1]):
            if (touched >> k) & 1 == 0:
                ties.partner[r, k, w] = 0
