# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Vertex block descent on a tetrahedral wall (Chen et al. 2024, "Vertex Block Descent", ACM TOG 43(4)).

The energy is the stable neo-Hookean of Newton's ``SolverVBD`` (Smith et al. 2018, ACM TOG 37(2)) with Newton's Lamé
parameters; force and Hessian of a vertex are written in closed form.
"""

import warp as wp

from arcgym.sim.wall.band_kernels import Rings, band_fields
from arcgym.sim.wall.band_matrix_kernels import BandMatrix, add_edge, add_pair
from arcgym.sim.wall.wall_kernels import VertexBlock
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class SolidElements:
    """Tetrahedra of a wall, and their rest shape in each of P patients."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    tets: wp.array[wp.vec4i]  # shape (T,)
    inv_rest: wp.array2d[wp.mat33]  # inverse rest edge matrix [1/m], shape (T, P)
    volume: wp.array2d[float]  # rest volume [m^3], shape (T, P)
    entry_start: wp.array[int]  # first entry of each vertex, shape (V + 1,)
    entry: wp.array[int]  # 4 * tet + corner, shape (4*T,)


@wp.func
def shape_gradient(inv_rest: wp.mat33, corner: int) -> wp.vec3:
    """Return the gradient of the corner's linear shape function at rest [1/m]."""
    if corner == 0:
        return -(inv_rest[0] + inv_rest[1] + inv_rest[2])
    return inv_rest[corner - 1]


@wp.func
def add_elastic(
    block: VertexBlock, solid: SolidElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the stable neo-Hookean terms of the tets around vertex ``i`` of world ``w``.

    P = mu F + (la (J - 1) - mu) cof F, with la = lambda + mu; the Hessian keeps mu |m|^2 I + la g g^T, g = cof(F) m.
    """
    out = block
    mu = moduli[0]
    la = moduli[1] + mu
    for k in range(solid.entry_start[i], solid.entry_start[i + 1]):
        entry = solid.entry[k]
        tet = entry // 4
        corners = solid.tets[tet]
        inv_rest = solid.inv_rest[tet, solid.patient[w]]
        x0 = x[corners[0], w]
        ds = wp.matrix_from_cols(x[corners[1], w] - x0, x[corners[2], w] - x0, x[corners[3], w] - x0)
        f = ds * inv_rest
        f0 = wp.vec3(f[0, 0], f[1, 0], f[2, 0])
        f1 = wp.vec3(f[0, 1], f[1, 1], f[2, 1])
        f2 = wp.vec3(f[0, 2], f[1, 2], f[2, 2])
        c0 = wp.cross(f1, f2)
        c1 = wp.cross(f2, f0)
        c2 = wp.cross(f0, f1)
        m = shape_gradient(inv_rest, entry - 4 * tet)
        g = c0 * m[0] + c1 * m[1] + c2 * m[2]
        vol = solid.volume[tet, solid.patient[w]]
        pressure = la * (wp.dot(f0, c0) - 1.0) - mu
        out.force -= vol * (mu * (f0 * m[0] + f1 * m[1] + f2 * m[2]) + pressure * g)
        out.hessian += vol * (la * wp.outer(g, g) + mu * wp.dot(m, m) * wp.identity(n=3, dtype=float))
    return out


@wp.func
def add_band_tet(
    band: BandMatrix,
    solid: SolidElements,
    rings: Rings,
    x: wp.array2d[wp.vec3],
    t: int,
    r: int,
    w: int,
    moduli: wp.vec3,
) -> BandMatrix:
    """Add a tet to the stiffness of the band of ring ``r``.

    The Hessian between two corners with shape gradients m and m' is V times (lambda' J^2 + q) h h'^T - q (h' h^T +
    h.h' Id) + (m.S m') Id, with h = F^-T m, lambda' = lambda + mu, q = (lambda' (J - 1) - mu) J and the stress S =
    mu Id + q C^-1; negative parts count as zero, and stretches below a tenth as a tenth.
    """
    p = solid.patient[w]
    corners = solid.tets[t]
    inv_rest = solid.inv_rest[t, p]
    x0 = x[corners[0], w]
    ds = wp.matrix_from_cols(x[corners[1], w] - x0, x[corners[2], w] - x0, x[corners[3], w] - x0)
    u, sigma, v = wp.svd3(ds * inv_rest)
    size = wp.vec3(wp.max(wp.abs(sigma[0]), 0.1), wp.max(wp.abs(sigma[1]), 0.1), wp.max(wp.abs(sigma[2]), 0.1))
    volume = size[0] * size[1] * size[2]
    mu = moduli[0]
    la = moduli[1] + mu
    pressure = (la * (volume - 1.0) - mu) * volume
    k = wp.max(-pressure, 0.0)
    spread = wp.max(la * volume * volume + pressure, 0.0)
    dual = u * wp.diag(wp.cw_div(wp.vec3(1.0), size)) * wp.transpose(v)
    stress = wp.vec3(0.0)
    for i in range(3):
        stress[i] = wp.max(mu + pressure / (size[i] * size[i]), 0.0)
    tension = v * wp.diag(stress) * wp.transpose(v)
    eye = wp.identity(n=3, dtype=float)
    out = band
    for a in range(4):
        m = shape_gradient(inv_rest, a)
        h = dual * m
        fields = band_fields(rings, corners[a], r, p)
        for b in range(a + 1):
            n = shape_gradient(inv_rest, b)
            g = dual * n
            block = spread * wp.outer(h, g) + k * wp.outer(g, h)
            block += (k * wp.dot(h, g) + wp.dot(m, tension * n)) * eye
            block = solid.volume[t, p] * block
            if a == b:
                out = add_edge(out, fields, block)
            else:
                out = add_pair(out, fields, band_fields(rings, corners[b], r, p), block)
    return out
