# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Push of the abdomen's inside on the wall, and the dent of a hand in its front.

The inside is a superellipsoid, f(q) = (sum of |q_i / a_i|^n)^(1/n) = 1 with the semi-axes a along the patient's axes.
Outside, a point is (f - 1) / |grad f| deep, to first order its distance; of a sphere that is exact. A hand moves the
front back by the dent times a window around its place: a point there is as deep as if it lay as much farther in front.
V wall vertices, R rings, P patients, W worlds.
"""

import warp as wp

from arcgym.sim.wall.outer_force_kernels import OuterForce, put_outer_force
from arcgym.utils import warp_setup  # noqa: F401

FARTHEST = wp.constant(0.9)
"""Farthest that a hand may be from the middle of the front, over half its width or height."""


@wp.struct
class AbdomenShape:
    """Inside of the abdomen of each of P patients, and what differs between worlds."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    members: wp.array2d[int]  # vertices of each ring, -1 padded, shape (R, S)
    center: wp.array[wp.vec3]  # [m], shape (P,)
    tight: wp.array[wp.vec3]  # semi-axes without a gap [m], shape (P,)
    area: wp.array2d[float]  # of the wall around each vertex [m^2], shape (V, P)
    gap: wp.array[float]  # added to the semi-axes [m], shape (W,)
    stiffness: wp.array[float]  # pressure over depth [Pa/m], shape (W,)
    squareness: float  # exponent n
    core: float  # where all |q_i / a_i| are less, a point is inside for sure
    damping: float  # over stiffness [s]


@wp.struct
class AbdominalHand:
    """A hand on the front of the abdomen of each world."""

    force: wp.array[float]  # with which it presses [N], shape (W,)
    place: wp.array[wp.vec2]  # to the right and cranial of where it was at first [m], shape (W,)
    dent: wp.array[float]  # how deep it has pressed the front in [m], shape (W,)
    home: wp.vec2  # where it is at first, over the semi-axes
    radius: float  # of the dent's floor [m]
    stiffness: float  # of the front alone [N/m]
    time: float  # in which the dent follows [s]
    deepest: float  # dent [m]


@wp.struct
class Depth:
    """How deep a point is in the abdomen's inside."""

    depth: float  # [m], not positive if it touches nothing
    normal: wp.vec3  # unit vector outwards
    yielding: float  # depth gained for each meter of dent


@wp.func
def semi_axes(shape: AbdomenShape, w: int) -> wp.vec3:
    """Return the semi-axes of world ``w`` [m]."""
    gap = shape.gap[w]
    return shape.tight[shape.patient[w]] + wp.vec3(gap, gap, gap)


@wp.func
def hand_window(away: float, radius: float) -> wp.vec2:
    """Return how much of the dent there is ``away`` from the hand's middle [m], and its slope [1/m]."""
    if away <= radius:
        return wp.vec2(1.0, 0.0)
    if away >= 2.0 * radius:
        return wp.vec2(0.0, 0.0)
    half = 0.5 * wp.pi * (away / radius - 1.0)
    return wp.vec2(wp.cos(half) * wp.cos(half), -0.5 * wp.pi / radius * wp.sin(2.0 * half))


@wp.func
def hand_place(shape: AbdomenShape, hand: AbdominalHand, axes: wp.vec3, w: int) -> wp.vec2:
    """Return where the hand of world ``w`` is, to the right and cranial of the abdomen's middle [m]."""
    at = hand.place[w] + wp.vec2(hand.home[0] * axes[0], hand.home[1] * axes[2])
    wide, high = FARTHEST * axes[0], FARTHEST * axes[2]
    return wp.vec2(wp.clamp(at[0], -wide, wide), wp.clamp(at[1], -high, high))


@wp.func
def depth_in_shape(q: wp.vec3, axes: wp.vec3, n: float, core: float) -> Depth:
    """Return how deep the point ``q`` from the middle is in a superellipsoid without a dent; its normal has a length.

    ``normal`` is the gradient of f and ``depth`` f - 1.
    """
    out = Depth()
    u = wp.vec3(wp.abs(q[0]) / axes[0], wp.abs(q[1]) / axes[1], wp.abs(q[2]) / axes[2])
    if wp.max(u) < core:
        return out
    total = wp.pow(u[0], n) + wp.pow(u[1], n) + wp.pow(u[2], n)
    if total > 1.0:
        f = wp.pow(total, 1.0 / n)
        out.depth = f - 1.0
        out.normal = wp.vec3(
            wp.sign(q[0]) * wp.pow(u[0] / f, n - 1.0) / axes[0],
            wp.sign(q[1]) * wp.pow(u[1] / f, n - 1.0) / axes[1],
            wp.sign(q[2]) * wp.pow(u[2] / f, n - 1.0) / axes[2],
        )
    return out


@wp.func
def depth_in_abdomen(shape: AbdomenShape, hand: AbdominalHand, x: wp.vec3, w: int) -> Depth:
    """Return how deep a point at ``x`` [m] is in the inside of world ``w``'s abdomen."""
    axes = semi_axes(shape, w)
    q = x - shape.center[shape.patient[w]]
    window = wp.vec2(0.0)
    aside = wp.vec2(0.0)
    dent = hand.dent[w]
    if dent > 0.0 and q[1] > 0.0:
        aside = wp.vec2(q[0], q[2]) - hand_place(shape, hand, axes, w)
        window = hand_window(wp.length(aside), hand.radius)
        q = q + wp.vec3(0.0, dent * window[0], 0.0)
    out = depth_in_shape(q, axes, shape.squareness, shape.core)
    if out.depth > 0.0:
        gradient = out.normal
        if window[1] != 0.0:
            slope = gradient[1] * dent * window[1] * wp.normalize(aside)
            gradient = gradient + wp.vec3(slope[0], 0.0, slope[1])
        steepness = wp.length(gradient)
        out.depth = out.depth / steepness
        out.normal = gradient / steepness
        out.yielding = window[0] * out.normal[1]
    return out


@wp.func
def press_wall(
    x: wp.array2d[wp.vec3],
    shape: AbdomenShape,
    hand: AbdominalHand,
    dt: float,
    outer: OuterForce,
    load: wp.array2d[wp.vec3],
    r: int,
    w: int,
):
    """Push what has gone outside of ring ``r`` of world ``w`` back in.

    Args:
        x: Wall positions [m], shape (V, W).
        shape: Insides.
        hand: Hands.
        dt: Physics step [s].
        outer: Forces; added to.
        load: Of each ring on the hand [N], its stiffness there [N/m], and push on the abdomen altogether [N], shape
            (R, W); written.
        r: Ring.
        w: World.
    """
    p = shape.patient[w]
    total = wp.vec3(0.0)
    for j in range(shape.members.shape[1]):
        i = shape.members[r, j]
        if i >= 0:
            at = depth_in_abdomen(shape, hand, x[i, w], w)
            if at.depth > 0.0:
                k = shape.stiffness[w] * shape.area[i, p]
                push = k * at.depth
                along = wp.outer(at.normal, at.normal)
                put_outer_force(outer, i, w, x[i, w], -push * at.normal, (k * (1.0 + shape.damping / dt)) * along)
                total += wp.vec3(push * at.yielding, k * at.yielding * at.yielding, push)
                outer.near[r, w] = 1
    load[r, w] = total


@wp.kernel
def move_hand(load: wp.array2d[wp.vec3], dt: float, hand: AbdominalHand, push: wp.array[float]):
    """Let every hand press the front in until front and colon resist as much. Launch (W,).

    The dent follows force - stiffness * dent - load through a damper of stiffness * time, implicitly.

    Args:
        load: As ``press_wall`` measured it, shape (R, W).
        dt: Physics step [s].
        hand: Hands; ``dent`` is updated.
        push: Of the colon on the abdomen [N], shape (W,); written.
    """
    w = wp.tid()
    total = wp.vec3(0.0)
    for r in range(load.shape[0]):
        total += load[r, w]
    dent = hand.dent[w]
    left = hand.force[w] - hand.stiffness * dent - total[0]
    dent += dt * left / (hand.stiffness * hand.time + dt * (hand.stiffness + total[1]))
    hand.dent[w] = wp.clamp(dent, 0.0, hand.deepest)
    push[w] = total[2]
