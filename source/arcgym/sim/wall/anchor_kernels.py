# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Law of the anchor springs: nearly free within the slack, tight beyond, see :mod:`arcgym.assets.anchors`."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Anchors:
    """Springs of one world's wall vertices to their rest positions, shared by all worlds."""

    stiffness: wp.array[float]  # of the tight spring [N/m], shape (V,)
    loose: wp.array[float]  # share of it within the slack, 1 where there is none, shape (V,)
    slack: wp.array[float]  # distance at which the spring gets tight [m], shape (V,)
    rest: wp.array[wp.vec3]  # [m], shape (V,)


@wp.func
def secant_share(distance: float, loose: float, slack: float) -> float:
    """Return the pull at ``distance`` [m] over what the tight spring alone would pull there."""
    if distance <= slack:
        return loose
    return 1.0 - (1.0 - loose) * slack / distance


@wp.func
def anchor_pull(anchors: Anchors, i: int, x: wp.vec3) -> wp.vec3:
    """Return the force on vertex ``i`` at ``x`` [N]."""
    u = x - anchors.rest[i]
    return -anchors.stiffness[i] * secant_share(wp.length(u), anchors.loose[i], anchors.slack[i]) * u


@wp.func
def anchor_hessian(anchors: Anchors, i: int, x: wp.vec3) -> wp.mat33:
    """Return the stiffness of vertex ``i``'s spring [N/m], positive definite: tangent along it, secant across it."""
    u = x - anchors.rest[i]
    d = wp.length(u)
    secant = secant_share(d, anchors.loose[i], anchors.slack[i])
    out = secant * wp.identity(n=3, dtype=float)
    if d > anchors.slack[i] and secant < 1.0:
        out += ((1.0 - secant) / (d * d)) * wp.outer(u, u)
    return anchors.stiffness[i] * out
