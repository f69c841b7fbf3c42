# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Law of the anchor springs: nearly free within the slack, tight beyond, see :mod:`arcgym.assets.anchors`."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Anchors:
    """Springs of the wall vertices of each of P patients to their rest positions. W worlds."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    stiffness: wp.array2d[float]  # of the tight spring [N/m], shape (V, P)
    loose: wp.array2d[float]  # share of it within the slack, 1 where there is none, shape (V, P)
    slack: wp.array2d[float]  # distance at which the spring gets tight [m], shape (V, P)
    rest: wp.array2d[wp.vec3]  # [m], shape (V, P)


@wp.func
def secant_share(distance: float, loose: float, slack: float) -> float:
    """Return the pull at ``distance`` [m] over what the tight spring alone would pull there."""
    if distance <= slack:
        return loose
    return 1.0 - (1.0 - loose) * slack / distance


@wp.func
def anchor_pull(anchors: Anchors, i: int, w: int, x: wp.vec3) -> wp.vec3:
    """Return the force on vertex ``i`` of world ``w`` at ``x`` [N]."""
    p = anchors.patient[w]
    u = x - anchors.rest[i, p]
    return -anchors.stiffness[i, p] * secant_share(wp.length(u), anchors.loose[i, p], anchors.slack[i, p]) * u


@wp.func
def anchor_hessian(anchors: Anchors, i: int, w: int, x: wp.vec3) -> wp.mat33:
    """Return the stiffness of vertex ``i``'s spring [N/m], positive definite: tangent along it, secant across it."""
    p = anchors.patient[w]
    u = x - anchors.rest[i, p]
    d = wp.length(u)
    secant = secant_share(d, anchors.loose[i, p], anchors.slack[i, p])
    out = secant * wp.identity(n=3, dtype=float)
    if d > anchors.slack[i, p] and secant < 1.0:
        out += ((1.0 - secant) / (d * d)) * wp.outer(u, u)
    return anchors.stiffness[i, p] * out
