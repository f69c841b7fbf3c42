# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact of the wall with itself where two loops of the colon touch, ring against ring.

The normal of a pair of rings lies along the line between their centers; each ring reaches as far towards the other as
its vertices on that side do. Pushed flat there, it reaches less far, and those vertices bear the force. A pair is
measured in the same way from both of its sides, so that action is reaction.
Launch dimensions: R rings, W worlds last.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

NO_CONTACT = wp.constant(-1.0e9)
"""Stands for the smallest gap of a pair of rings that never push on each other [m]."""
REST_MARGIN = wp.constant(1.0e-4)
"""Distance that rings which touch at rest must come closer before they push [m]."""
MAX_OVERLAP = wp.constant(0.005)
"""Overlap beyond which a pair pushes no harder [m]: a crumpled wall may overlap deeply from one step to the next."""
NESTED_RATIO = wp.constant(0.5)
"""Distance of two centers over the extent of the rings, under which one is inside the other and nothing pushes."""
STIFFNESS_RAMP = wp.constant(0.25)
"""Range of that ratio, and of arc length over its least, within which the stiffness grows to its full value."""
MIN_FORCE = wp.constant(1.0e-9)
"""Force under which a vertex counts as untouched [N]."""


@wp.struct
class WallRings:
    """Rings of the wall of each of P patients."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    half_min_arc: wp.array2d[float]  # half the least arc length at which two such rings may touch [m], shape (R, P)
    next_candidate: wp.array2d[int]  # first ring after each that may touch it, shape (R, P)
    min_gap: wp.array3d[float]  # gap below which a pair pushes, negative where it overlaps at rest [m], shape (R, R, P)
    thickness: float  # distance between vertices of walls that touch [m]
    max_radius: wp.array[float]  # no ring reaches farther from its center than this [m], shape (P,)
    max_spacing: wp.array[float]  # no two neighboring rings are farther apart than this [m], shape (P,)
    stiffness: float  # of a pair [N/m]


@wp.struct
class SelfContactForce:
    """Self-contact measured at the start of a step: force (c - k n.x) n on a vertex at x, until the end of the step.

    Clamping the force at zero within the step would make light vertices jump in and out of contact. The other side is
    taken to move back as much, which doubles the stiffness k.
    """

    plane: wp.array2d[wp.vec4]  # n and c [N], shape (V, W)
    stiffness: wp.array2d[float]  # k [N/m], zero where nothing touches, shape (V, W)
    in_contact: wp.array2d[int]  # 1 where a ring touches another, shape (R, W)


@wp.struct
class RingSpheres:
    """Bounding spheres of the rings, in each world."""

    sphere: wp.array2d[wp.vec4]  # center and distance of the farthest vertex from there [m], shape (R, W)
    near: wp.array2d[int]  # 1 where a sphere meets that of a ring that may touch, shape (R, W)


@wp.kernel
def measure_spheres(x: wp.array2d[wp.vec3], rings: WallRings, spheres: RingSpheres):
    """Write the bounding sphere of each ring at the positions ``x`` [m], shape (V, W). Launch (R, W)."""
    r, w = wp.tid()
    center = wp.vec3(0.0)
    count = float(0.0)
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            center += x[i, w]
            count += 1.0
    center /= count
    farthest = float(0.0)
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            farthest = wp.max(farthest, wp.length_sq(x[i, w] - center))
    spheres.sphere[r, w] = wp.vec4(center[0], center[1], center[2], wp.sqrt(farthest))
    spheres.near[r, w] = 0


@wp.func
def xyz(sphere: wp.vec4) -> wp.vec3:
    """Return the first three components, such as the center of a sphere."""
    return wp.vec3(sphere[0], sphere[1], sphere[2])


@wp.func
def facing_weight(x: wp.vec3, sphere: wp.vec4, n: wp.vec3) -> float:
    """Return the weight of a vertex at ``x`` on the side ``n`` of its ring, 0 to 1: the eighth power of a cosine."""
    side = wp.max(wp.dot(x - xyz(sphere), n) / sphere[3], 0.0)
    square = side * side
    return square * square * square * square


@wp.func
def facing_extent(rings: WallRings, x: wp.array2d[wp.vec3], r: int, w: int, sphere: wp.vec4, n: wp.vec3) -> wp.vec2:
    """Return the weighted extent of ring ``r`` towards ``n`` [m], and the sum of its vertices' weights."""
    reach = float(0.0)
    total = float(1.0e-12)
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            share = facing_weight(x[i, w], sphere, n)
            reach += share * wp.dot(x[i, w] - xyz(sphere), n)
            total += share
    return wp.vec2(reach / total, total)


@wp.func
def pair_gap(
    rings: WallRings, x: wp.array2d[wp.vec3], r: int, s: int, w: int, own: wp.vec4, other: wp.vec4, n: wp.vec3
) -> float:
    """Return the gap between the outer surfaces of rings ``r`` and ``s`` along ``n``, negative in overlap [m]."""
    reach = facing_extent(rings, x, r, w, own, n)[0] + facing_extent(rings, x, s, w, other, -n)[0]
    return wp.length(xyz(other) - xyz(own)) - reach - rings.thickness


@wp.kernel
def allow_rest_overlaps(x: wp.array2d[wp.vec3], spheres: RingSpheres, rings: WallRings):
    """Lower ``rings.min_gap`` of pairs that overlap at rest. Launch (R, R, P), one world with each patient.

    Args:
        x: Rest positions [m], shape (V, P).
        spheres: Bounding spheres there.
        rings: Rings; ``min_gap`` is changed in place.
    """
    r, s, p = wp.tid()
    if rings.min_gap[r, s, p] > NO_CONTACT:
        n = wp.normalize(xyz(spheres.sphere[s, p]) - xyz(spheres.sphere[r, p]))
        gap = pair_gap(rings, x, r, s, p, spheres.sphere[r, p], spheres.sphere[s, p], n)
        rings.min_gap[r, s, p] = wp.min(gap - REST_MARGIN, 0.0)


@wp.func
def arc_between(spheres: RingSpheres, r: int, s: int, w: int, longest: float) -> float:
    """Return the arc length along the deformed colon between two rings, counted up to ``longest`` [m]."""
    arc = float(0.0)
    k = wp.min(r, s)
    while k < wp.max(r, s) and arc < longest:
        arc += wp.length(xyz(spheres.sphere[k + 1, w]) - xyz(spheres.sphere[k, w]))
        k += 1
    return arc


@wp.func
def pair_stiffness(
    rings: WallRings, spheres: RingSpheres, r: int, s: int, w: int, apart: float, overlap: float
) -> float:
    """Return the stiffness of a pair, centers ``apart`` [m], in N/m: zero where wall is gathered on the shaft."""
    p = rings.patient[w]
    least = rings.half_min_arc[r, p] + rings.half_min_arc[s, p]
    around = arc_between(spheres, r, s, w, (1.0 + STIFFNESS_RAMP) * least) / least - 1.0
    beside = apart / (apart + overlap) - NESTED_RATIO
    return rings.stiffness * wp.clamp(wp.min(around, beside) / STIFFNESS_RAMP, 0.0, 1.0)


@wp.func
def add_pair(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    r: int,
    w: int,
    own: wp.vec4,
    n: wp.vec3,
    push: float,
    stiffness: float,
    first: bool,
    out: SelfContactForce,
):
    """Distribute a force ``push`` [N] along -n over the vertices of ring ``r``; ``first`` clears earlier ones."""
    total = facing_extent(rings, x, r, w, own, n)[1]
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            share = facing_weight(x[i, w], own, n) / total
            force = (-share * push) * n
            if first:
                out.plane[i, w] = wp.vec4(force[0], force[1], force[2], 0.0)
                out.stiffness[i, w] = 2.0 * share * stiffness
            else:
                out.plane[i, w] = out.plane[i, w] + wp.vec4(force[0], force[1], force[2], 0.0)
                out.stiffness[i, w] = out.stiffness[i, w] + 2.0 * share * stiffness


@wp.func
def finish_ring(rings: WallRings, x: wp.array2d[wp.vec3], r: int, w: int, in_contact: int, out: SelfContactForce):
    """Turn the forces on ring ``r`` into planes, or clear the ring."""
    for k in range(rings.members.shape[1]):
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


@wp.func
def rings_to_skip(rings: WallRings, own: wp.vec4, distance: float, w: int) -> int:
    """Return how many rings after one at ``distance`` [m] cannot reach ``own``, however far the tube is stretched."""
    p = rings.patient[w]
    return int(wp.max(0.0, (distance - own[3] - rings.thickness - rings.max_radius[p]) / rings.max_spacing[p]))


@wp.kernel
def find_near_rings(rings: WallRings, spheres: RingSpheres):
    """Mark the rings whose spheres meet in ``spheres.near``. Launch (R, W)."""
    r, w = wp.tid()
    own = spheres.sphere[r, w]
    s = rings.next_candidate[r, rings.patient[w]]
    while s < rings.members.shape[0]:
        other = spheres.sphere[s, w]
        d = wp.length(xyz(other) - xyz(own))
        if d < own[3] + other[3] + rings.thickness:
            spheres.near[r, w] = 1
            spheres.near[s, w] = 1
        s += 1 + rings_to_skip(rings, own, d, w)


@wp.kernel
def measure_self_contact(x: wp.array2d[wp.vec3], rings: WallRings, spheres: RingSpheres, out: SelfContactForce):
    """Measure the contact of each ring with all others at the positions ``x`` [m], shape (V, W). Launch (R, W)."""
    r, w = wp.tid()
    if spheres.near[r, w] == 0 and out.in_contact[r, w] == 0:
        return
    own = spheres.sphere[r, w]
    in_contact = int(0)
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
                stiffness = pair_stiffness(rings, spheres, r, s, w, d, depth)
                add_pair(
                    rings, x, r, w, own, n, stiffness * wp.min(depth, MAX_OVERLAP), stiffness, in_contact == 0, out
                )
                in_contact = 1
        s += 1 + rings_to_skip(rings, own, d, w)
    finish_ring(rings, x, r, w, in_contact, out)
    out.in_contact[r, w] = in_contact
