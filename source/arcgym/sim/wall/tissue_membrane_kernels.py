# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Stretching of a triangle as in :mod:`arcgym.sim.wall.shell_kernels`, with a factor of stiffening of its own.

The functions are apart from those of the plain shell, whose figures must not depend on the last bit on options: code
that is shared is compiled otherwise, and rounds otherwise.
"""

import warp as wp

from arcgym.sim.wall.shell_kernels import EdgeStiffness, Stretch, edge_tensions, membrane_stretch, positive_part
from arcgym.sim.wall.wall_kernels import VertexBlock
from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def tissue_stretch(d1: wp.vec3, d2: wp.vec3, rest: wp.vec4, moduli: wp.vec3, stiffening: float) -> Stretch:
    """Return the stress of a triangle as ``membrane_stretch``, with shear mu (1 + b (I - 2)^2)."""
    out = membrane_stretch(d1, d2, rest, moduli)
    out.shear = moduli[0] * (1.0 + stiffening * out.excess * out.excess)
    return out


@wp.func
def add_tissue_stretching(
    block: VertexBlock, rest: wp.vec4, d1: wp.vec3, d2: wp.vec3, moduli: wp.vec3, stiffening: float
) -> VertexBlock:
    """Add the membrane terms of a triangle to its first corner, from where the edges ``d1`` and ``d2`` lead.

    With the corner's shape gradient m, g = F m, h = F C^-1 m, the normal n and s = mu (1 + b (I - 2)^2) |m|^2, the
    Hessian is A times s (Id - n n^T) + (lambda + mu - lambda ln J) h h^T + (s + (lambda ln J - mu) m.C^-1 m) n n^T
    + 4 b mu (I - 2) g g^T; negative factors, of a compressed triangle that would buckle, count as zero.
    """
    now = tissue_stretch(d1, d2, rest, moduli, stiffening)
    pull = edge_tensions(now, rest)
    h = now.dots[2] * d1 + now.dots[1] * d2
    g = rest[2] * d1 + rest[1] * d2
    n = wp.cross(d1, d2)
    s = now.shear * (rest[1] + rest[2])
    along = wp.max(moduli[1] - now.spread, 0.0) * now.inverse * now.inverse
    across = wp.max(s + now.spread * now.inverse * (now.dots[1] + now.dots[2]), 0.0)
    stretched = 4.0 * stiffening * moduli[0] * now.excess
    out = block
    out.force += pull[2] * d1 + pull[1] * d2
    out.hessian += (rest[3] * s) * wp.identity(n=3, dtype=float)
    out.hessian += (rest[3] * along) * wp.outer(h, h) + (rest[3] * stretched) * wp.outer(g, g)
    out.hessian += (rest[3] * (across - s) * now.inverse) * wp.outer(n, n)
    return out


@wp.func
def tissue_edge_stiffness(d1: wp.vec3, d2: wp.vec3, rest: wp.vec4, moduli: wp.vec3, stiffening: float) -> EdgeStiffness:
    """Return the Hessian of the membrane in the edges ``d1`` and ``d2``, without its negative parts.

    Between edges a and b it is A times lambda h_a h_b^T + k (h_b h_a^T + h_a.h_b (Id - n n^T)) + T_ab Id +
    4 b mu (I - 2) g_a g_b^T, with the edges' duals h in the triangle and g at rest, k = mu - lambda ln J and the
    tension T: Bonet and Wood, section 6.5. ``add_tissue_stretching`` is the same for one corner.
    """
    now = tissue_stretch(d1, d2, rest, moduli, stiffening)
    inv11 = now.inverse * (now.dots[0] + now.dots[2])
    inv22 = now.inverse * (now.dots[0] + now.dots[1])
    inv12 = -now.inverse * now.dots[0]
    h1 = inv11 * d1 + inv12 * d2
    h2 = inv12 * d1 + inv22 * d2
    rest11 = rest[2] + rest[0]
    rest22 = rest[1] + rest[0]
    tension = rest[3] * positive_part(
        now.shear * rest11 + now.spread * inv11,
        now.spread * inv12 - now.shear * rest[0],
        now.shear * rest22 + now.spread * inv22,
    )
    k = rest[3] * wp.max(-now.spread, 0.0)
    spread = rest[3] * moduli[1]
    n = wp.cross(d1, d2)
    eye = wp.identity(n=3, dtype=float)
    plane = k * (eye - now.inverse * wp.outer(n, n))
    out = EdgeStiffness()
    out.one = (spread + k) * wp.outer(h1, h1) + inv11 * plane + tension[0] * eye
    out.two = (spread + k) * wp.outer(h2, h2) + inv22 * plane + tension[2] * eye
    out.both = spread * wp.outer(h1, h2) + k * wp.outer(h2, h1) + inv12 * plane + tension[1] * eye
    stretched = 4.0 * stiffening * moduli[0] * now.excess * rest[3]
    if stretched > 0.0:
        g1 = rest11 * d1 - rest[0] * d2
        g2 = rest22 * d2 - rest[0] * d1
        out.one += stretched * wp.outer(g1, g1)
        out.two += stretched * wp.outer(g2, g2)
        out.both += stretched * wp.outer(g1, g2)
    return out
