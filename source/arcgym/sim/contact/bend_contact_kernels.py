# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Contact of the two limbs of a bend that is drawn to a hairpin, ring against ring, see ``self_contact_kernels``.

Rings nearer along the colon than a tube needs to turn back on itself do not push on each other as loops do. Here they
push where the colon runs opposite ways in them and they lie side by side, as in a hairpin: neither so in a straight
tube, however it is gathered, nor between neighbors in a bend. What two rings push as loops is left out.
V wall vertices, R rings, W worlds, P patients.
"""

import warp as wp

from arcgym.sim.contact.self_contact_kernels import (
    MAX_OVERLAP,
    NESTED_RATIO,
    NO_CONTACT,
    STIFFNESS_RAMP,
    RingSpheres,
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

TURNED = wp.constant(0.25)
"""Cosine between the course in one ring and that back in the other from which on they push: turned by 104 degrees. The
stiffness grows to its full value within ``STIFFNESS_RAMP``, at 120 degrees."""
BESIDE = wp.constant(0.5)
"""Squared sine between course and line of centers from which on they push: 45 degrees. Full from 60 degrees on."""


@wp.struct
class Bends:
    """Rings whose bends push, with the gaps below which they do."""

    rings: WallRings  # ``min_gap`` holds for all pairs, shape (R, R, P)
    spheres: RingSpheres
    loop_gap: wp.array3d[float]  # gap below which two rings push as loops, or ``NO_CONTACT`` [m], shape (R, R, P)


@wp.func
def course(spheres: RingSpheres, r: int, w: int) -> wp.vec3:
    """Return the way from the ring before ring ``r`` to the one after it [m]."""
    ahead = spheres.sphere[wp.min(r + 1, spheres.sphere.shape[0] - 1), w]
    return xyz(ahead) - xyz(spheres.sphere[wp.max(r - 1, 0), w])


@wp.func
def hairpin_share(here: wp.vec3, there: wp.vec3, n: wp.vec3) -> float:
    """Return the share of the stiffness, 0 to 1, of rings in which the colon runs ``here`` and ``there``."""
    if wp.dot(here, there) >= 0.0:
        return 0.0
    here = wp.normalize(here)
    there = wp.normalize(there)
    along = wp.max(wp.abs(wp.dot(here, n)), wp.abs(wp.dot(there, n)))
    turned = -wp.dot(here, there) - TURNED
    beside = 1.0 - along * along - BESIDE
    return wp.clamp(wp.min(turned, beside) / STIFFNESS_RAMP, 0.0, 1.0)


@wp.func
def loop_stiffness(bends: Bends, r: int, s: int, w: int, apart: float, gap: float) -> float:
    """Return the stiffness with which two rings push on each other as loops [N/m]."""
    least = bends.loop_gap[r, s, bends.rings.patient[w]]
    out = float(0.0)
    if least > NO_CONTACT and gap < least:
        out = pair_stiffness(bends.rings, bends.spheres, r, s, w, apart, least - gap)
    return out


@wp.func
def push_ring(
    rings: WallRings,
    x: wp.array2d[wp.vec3],
    r: int,
    w: int,
    own: wp.vec4,
    n: wp.vec3,
    push: float,
    stiffness: float,
    outer: OuterForce,
):
    """Distribute ``push`` [N] along -n over the side ``n`` of ring ``r``; the other side moves back as much."""
    total = facing_extent(rings, x, r, w, own, n)[1]
    for k in range(rings.members.shape[1]):
        i = rings.members[r, k]
        if i >= 0:
            share = facing_weight(x[i, w], own, n) / total
            put_outer_force(outer, i, w, x[i, w], (-share * push) * n, (2.0 * share * stiffness) * wp.outer(n, n))
    outer.near[r, w] = 1


@wp.func
def push_limbs(x: wp.array2d[wp.vec3], bends: Bends, outer: OuterForce, r: int, w: int):
    """Push ring ``r`` away from those of the other limb of its bend.

    Args:
        x: Wall positions [m], shape (V, W).
        bends: The rings, their spheres at ``x``.
        outer: Forces; added to.
        r: Ring.
        w: World.
    """
    own = bends.spheres.sphere[r, w]
    here = course(bends.spheres, r, w)
    s = int(0)
    while s < bends.rings.members.shape[0]:
        other = bends.spheres.sphere[s, w]
        offset = xyz(other) - xyz(own)
        d = wp.length(offset)
        if d < own[3] + other[3] + bends.rings.thickness and d > 0.0:
            n = offset / d
            share = hairpin_share(here, course(bends.spheres, s, w), n)
            if share > 0.0:
                gap = pair_gap(bends.rings, x, r, s, w, own, other, n)
                depth = bends.rings.min_gap[r, s, bends.rings.patient[w]] - gap
                if depth > 0.0:
                    share = wp.min(share, (d / (d + depth) - NESTED_RATIO) / STIFFNESS_RAMP)
                    stiffness = bends.rings.stiffness * share - loop_stiffness(bends, r, s, w, d, gap)
                    if stiffness > 0.0:
                        push_ring(
                            bends.rings, x, r, w, own, n, stiffness * wp.min(depth, MAX_OVERLAP), stiffness, outer
                        )
        s += 1 + rings_to_skip(bends.rings, own, d, w)
