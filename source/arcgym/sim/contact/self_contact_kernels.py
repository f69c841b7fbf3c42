# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact of the wall with itself where two loops of the colon touch, ring against ring.

The normal of a pair of rings lies along the line between their centres; each ring reaches as far towards the other as
its vertices on that side do. Pushed flat there, it reaches less far, and those vertices bear the force. A pair is
measured in the same way from both of its sides, so that action is reaction.
Launch dimensions: R rings, W worlds last.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

NEVER = wp.constant(-1.0e9)
"""Gap allowed to rings of the same stretch, which do not touch each other [m]."""
REST_MARGIN = wp.constant(1.0e-4)
"""How much closer than at rest rings must come that touch at rest [m]."""
DEEPEST = wp.constant(0.005)
"""Overlap beyond which a pair pushes no harder [m]: a crumpled wall may overlap deeply from one step to the next."""
NESTED = wp.constant(0.5)
"""Distance of two centres over how far the rings reach, under which one is inside the other and nothing pushes."""
ONSET = wp.constant(0.25)
"""Range of that ratio, and of the way between rings over its least, within which the stiffness grows to its whole."""
FAINT = wp.constant(1.0e-9)
"""Force under which a vertex counts as untouched [N]."""


@wp.struct
class LoopShape:
    """Rings of one world's wall, shared by all worlds."""

    members: wp.array2d(dtype=int)  # vertices of each ring, -1 padded, shape (R, S)
    half_bend: wp.array(dtype=float)  # half the least way along the colon between two such rings that touch, shape (R,)
    next_touch: wp.array(dtype=int)  # first ring after each that may touch it, shape (R,)
    allowed: wp.array2d(dtype=float)  # smallest gap of each pair, negative where they overlap at rest [m], shape (R, R)
    thickness: float  # distance between vertices of walls that touch [m]
    widest: float  # no ring reaches farther from its centre than this [m]
    pitch: float  # no two neighbouring rings are farther apart than this [m]
    stiffness: float  # of a pair [N/m]


@wp.struct
class LoopPress:
    """Self-contact measured at the start of a step: on a vertex at x it pushes along n by c - k n.x until its end.

    Were the push to stop within the step where that is negative, light vertices would jump in and out of contact. The
    other side is taken to give way as much, which doubles the stiffness k.
    """

    plane: wp.array2d(dtype=wp.vec4)  # n and c [N], shape (V, W)
    stiffness: wp.array2d(dtype=float)  # k [N/m], zero where nothing touches, shape (V, W)
    touched: wp.array2d(dtype=int)  # 1 where a ring touches another, shape (R, W)


@wp.struct
class RingBalls:
    """The spheres that rings fill, in each world."""

    ball: wp.array2d(dtype=wp.vec4)  # centre and distance of the farthest vertex from there [m], shape (R, W)
    near: wp.array2d(dtype=int)  # 1 where a sphere meets that of a ring that may touch, shape (R, W)


@wp.kernel
def measure_balls(x: wp.array2d(dtype=wp.vec3), shape: LoopShape, balls: RingBalls):
    """Sphere of each ring. Launch (R, W)."""
    r, w = wp.tid()
    center = wp.vec3(0.0)
    count = float(0.0)
    for k in range(shape.members.shape[1]):
        i = shape.members[r, k]
        if i >= 0:
            center += x[i, w]
            count += 1.0
    center /= count
    farthest = float(0.0)
    for k in range(shape.members.shape[1]):
        i = shape.members[r, k]
        if i >= 0:
            farthest = wp.max(farthest, wp.length_sq(x[i, w] - center))
    balls.ball[r, w] = wp.vec4(center[0], center[1], center[2], wp.sqrt(farthest))
    balls.near[r, w] = 0


@wp.func
def center_of(ball: wp.vec4) -> wp.vec3:
    """Centre of a ring [m]."""
    return wp.vec3(ball[0], ball[1], ball[2])


@wp.func
def share_of(x: wp.vec3, ball: wp.vec4, n: wp.vec3) -> float:
    """How much a vertex at ``x`` is on the side ``n`` of its ring, 0 to 1: the eighth power of a cosine."""
    side = wp.max(wp.dot(x - center_of(ball), n) / ball[3], 0.0)
    square = side * side
    return square * square * square * square


@wp.func
def facing(shape: LoopShape, x: wp.array2d(dtype=wp.vec3), r: int, w: int, ball: wp.vec4, n: wp.vec3) -> wp.vec2:
    """How far ring ``r`` reaches towards ``n`` [m], weighted by share, and the sum of its vertices' shares."""
    reach = float(0.0)
    total = float(1.0e-12)
    for k in range(shape.members.shape[1]):
        i = shape.members[r, k]
        if i >= 0:
            share = share_of(x[i, w], ball, n)
            reach += share * wp.dot(x[i, w] - center_of(ball), n)
            total += share
    return wp.vec2(reach / total, total)


@wp.func
def pair_gap(
    shape: LoopShape, x: wp.array2d(dtype=wp.vec3), r: int, s: int, w: int, own: wp.vec4, other: wp.vec4, n: wp.vec3
) -> float:
    """Distance between the outer surfaces of rings ``r`` and ``s`` along ``n``, negative where they overlap [m]."""
    reach = facing(shape, x, r, w, own, n)[0] + facing(shape, x, s, w, other, -n)[0]
    return wp.length(center_of(other) - center_of(own)) - reach - shape.thickness


@wp.kernel
def rest_gaps(x: wp.array2d(dtype=wp.vec3), shape: LoopShape, balls: RingBalls):
    """Allow the pairs that overlap at rest to do so. Launch (R, R)."""
    r, s = wp.tid()
    if shape.allowed[r, s] > NEVER:
        n = wp.normalize(center_of(balls.ball[s, 0]) - center_of(balls.ball[r, 0]))
        gap = pair_gap(shape, x, r, s, 0, balls.ball[r, 0], balls.ball[s, 0], n)
        shape.allowed[r, s] = wp.min(gap - REST_MARGIN, 0.0)


@wp.func
def way_between(balls: RingBalls, r: int, s: int, w: int, longest: float) -> float:
    """Way along the deformed colon between two rings, counted up to ``longest`` [m]."""
    way = float(0.0)
    k = wp.min(r, s)
    while k < wp.max(r, s) and way < longest:
        way += wp.length(center_of(balls.ball[k + 1, w]) - center_of(balls.ball[k, w]))
        k += 1
    return way


@wp.func
def pair_stiffness(shape: LoopShape, balls: RingBalls, r: int, s: int, w: int, apart: float, overlap: float) -> float:
    """Stiffness of a pair, centres ``apart`` [m], in N/m: none where one stretch of wall is gathered on the shaft."""
    least = shape.half_bend[r] + shape.half_bend[s]
    around = way_between(balls, r, s, w, (1.0 + ONSET) * least) / least - 1.0
    beside = apart / (apart + overlap) - NESTED
    return shape.stiffness * wp.clamp(wp.min(around, beside) / ONSET, 0.0, 1.0)


@wp.func
def add_pair(
    shape: LoopShape,
    x: wp.array2d(dtype=wp.vec3),
    r: int,
    w: int,
    own: wp.vec4,
    n: wp.vec3,
    push: float,
    stiffness: float,
    first: bool,
    press: LoopPress,
):
    """Share a force ``push`` [N] along -n between the vertices of ring ``r``; ``first`` clears what was there."""
    total = facing(shape, x, r, w, own, n)[1]
    for k in range(shape.members.shape[1]):
        i = shape.members[r, k]
        if i >= 0:
            share = share_of(x[i, w], own, n) / total
            force = (-share * push) * n
            if first:
                press.plane[i, w] = wp.vec4(force[0], force[1], force[2], 0.0)
                press.stiffness[i, w] = 2.0 * share * stiffness
            else:
                press.plane[i, w] = press.plane[i, w] + wp.vec4(force[0], force[1], force[2], 0.0)
                press.stiffness[i, w] = press.stiffness[i, w] + 2.0 * share * stiffness


@wp.func
def finish_ring(shape: LoopShape, x: wp.array2d(dtype=wp.vec3), r: int, w: int, touched: int, press: LoopPress):
    """Turn the forces on ring ``r`` into planes, or clear the ring."""
    for k in range(shape.members.shape[1]):
        i = shape.members[r, k]
        if i >= 0:
            force = center_of(press.plane[i, w])
            size = wp.length(force)
            if touched == 1 and size > FAINT:
                n = force / size
                c = size + press.stiffness[i, w] * wp.dot(n, x[i, w])
                press.plane[i, w] = wp.vec4(n[0], n[1], n[2], c)
            else:
                press.stiffness[i, w] = 0.0


@wp.func
def rings_to_skip(shape: LoopShape, own: wp.vec4, distance: float) -> int:
    """How many rings after one at ``distance`` [m] cannot reach ``own``, however far the tube is stretched."""
    return int(wp.max(0.0, (distance - own[3] - shape.thickness - shape.widest) / shape.pitch))


@wp.kernel
def find_near(shape: LoopShape, balls: RingBalls):
    """Mark the rings whose spheres meet. Launch (R, W)."""
    r, w = wp.tid()
    own = balls.ball[r, w]
    s = shape.next_touch[r]
    while s < shape.members.shape[0]:
        other = balls.ball[s, w]
        d = wp.length(center_of(other) - center_of(own))
        if d < own[3] + other[3] + shape.thickness:
            balls.near[r, w] = 1
            balls.near[s, w] = 1
        s += 1 + rings_to_skip(shape, own, d)


@wp.kernel
def press_loops(x: wp.array2d(dtype=wp.vec3), shape: LoopShape, balls: RingBalls, press: LoopPress):
    """Measure the contact of each ring with all others. Launch (R, W)."""
    r, w = wp.tid()
    if balls.near[r, w] == 0 and press.touched[r, w] == 0:
        return
    own = balls.ball[r, w]
    touched = int(0)
    s = int(0)
    while s < shape.members.shape[0]:
        other = balls.ball[s, w]
        way = center_of(other) - center_of(own)
        d = wp.length(way)
        if d < own[3] + other[3] + shape.thickness and shape.allowed[r, s] > NEVER and d > 0.0:
            n = way / d
            depth = shape.allowed[r, s] - pair_gap(shape, x, r, s, w, own, other, n)
            if depth > 0.0:
                stiffness = pair_stiffness(shape, balls, r, s, w, d, depth)
                add_pair(shape, x, r, w, own, n, stiffness * wp.min(depth, DEEPEST), stiffness, touched == 0, press)
                touched = 1
        s += 1 + rings_to_skip(shape, own, d)
    finish_ring(shape, x, r, w, touched, press)
    press.touched[r, w] = touched
