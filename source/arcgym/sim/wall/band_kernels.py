# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Stiffness of the wall's bands in the modes of their two rings, at the present shape.

A band is what lies between a ring and the next one. A ring moves by x_i += t + p_i g_p + q_i g_q, with the in-plane
coordinates (p, q) that its vertices have at rest. Moving both rings alike strains nothing, so that a band's energy has
five vectors: how far the ring's t is from the next one's, its g_p and g_q, and those of the next ring. In every element
each of them moves the corners by a number times the vector; only differences of the numbers along the edges count.

Bending along the colon joins three rings, which a system of neighbours cannot hold: a band has a bound of it, see
``ring_modes.bending_bound``, with the rings' widening and flattening measured in the plane in which each lies now.
"""

import warp as wp

from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Rings:
    """Rings of the wall of each of P patients, and the elements of the bands between them."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    ring: wp.array[int]  # ring of each vertex, shape (V,)
    plane: wp.array2d[wp.vec2]  # in-plane coordinates (p, q) of each vertex over the ring's rms radius, shape (V, P)
    bending: wp.array2d[wp.mat33]  # factor of each band's bound on bending, see ring_modes [1/m], shape (R, P)
    moves: wp.array2d[int]  # 1 where a whole ring moves, shape (R, P)
    band_start: wp.array[int]  # first element of each ring's band, shape (R + 1,)
    band: wp.array[int]  # elements, sorted by band, shape (E,)


@wp.struct
class BandMatrix:
    """Upper blocks of a band's stiffness between its five vectors [N/m]."""

    k00: wp.mat33
    k01: wp.mat33
    k02: wp.mat33
    k03: wp.mat33
    k04: wp.mat33
    k11: wp.mat33
    k12: wp.mat33
    k13: wp.mat33
    k14: wp.mat33
    k22: wp.mat33
    k23: wp.mat33
    k24: wp.mat33
    k33: wp.mat33
    k34: wp.mat33
    k44: wp.mat33


Five = wp.types.vector(length=5, dtype=float)
"""Values at a point of the five fields that a band's vectors are multiplied with."""


@wp.func
def band_fields(rings: Rings, i: int, r: int, p: int) -> Five:
    """Return the five fields of the band of ring ``r`` at vertex ``i`` of patient ``p``."""
    plane = rings.plane[i, p]
    if rings.ring[i] == r:
        return Five(1.0, plane[0], plane[1], 0.0, 0.0)
    return Five(0.0, 0.0, 0.0, plane[0], plane[1])


@wp.func
def add_edges(band: BandMatrix, a: Five, b: Five, aa: wp.mat33, ab: wp.mat33, bb: wp.mat33) -> BandMatrix:
    """Add the stiffness between two edges of an element.

    Args:
        band: Matrix of the band.
        a: Differences of the fields along one edge.
        b: Differences along the other.
        aa: Stiffness of the one edge [N/m].
        ab: Stiffness between the one and the other.
        bb: Stiffness of the other.
    """
    out = band
    ba = wp.transpose(ab)
    u = a[0] * aa + b[0] * ab
    v = a[0] * ba + b[0] * bb
    out.k00 += a[0] * u + b[0] * v
    u = a[1] * aa + b[1] * ab
    v = a[1] * ba + b[1] * bb
    out.k01 += a[0] * u + b[0] * v
    out.k11 += a[1] * u + b[1] * v
    u = a[2] * aa + b[2] * ab
    v = a[2] * ba + b[2] * bb
    out.k02 += a[0] * u + b[0] * v
    out.k12 += a[1] * u + b[1] * v
    out.k22 += a[2] * u + b[2] * v
    u = a[3] * aa + b[3] * ab
    v = a[3] * ba + b[3] * bb
    out.k03 += a[0] * u + b[0] * v
    out.k13 += a[1] * u + b[1] * v
    out.k23 += a[2] * u + b[2] * v
    out.k33 += a[3] * u + b[3] * v
    u = a[4] * aa + b[4] * ab
    v = a[4] * ba + b[4] * bb
    out.k04 += a[0] * u + b[0] * v
    out.k14 += a[1] * u + b[1] * v
    out.k24 += a[2] * u + b[2] * v
    out.k34 += a[3] * u + b[3] * v
    out.k44 += a[4] * u + b[4] * v
    return out


@wp.struct
class RingAxes:
    """Directions in which the in-plane coordinates of each ring point now, shape (R, W)."""

    p: wp.array2d[wp.vec3]
    q: wp.array2d[wp.vec3]


@wp.func
def add_strain_difference(
    band: BandMatrix, k: float, a_p: wp.vec3, a_q: wp.vec3, b_p: wp.vec3, b_q: wp.vec3
) -> BandMatrix:
    """Add a spring ``k`` on b_p.g_p + b_q.g_q of the next ring less a_p.g_p + a_q.g_q of this one."""
    out = band
    out.k11 += k * wp.outer(a_p, a_p)
    out.k12 += k * wp.outer(a_p, a_q)
    out.k13 -= k * wp.outer(a_p, b_p)
    out.k14 -= k * wp.outer(a_p, b_q)
    out.k22 += k * wp.outer(a_q, a_q)
    out.k23 -= k * wp.outer(a_q, b_p)
    out.k24 -= k * wp.outer(a_q, b_q)
    out.k33 += k * wp.outer(b_p, b_p)
    out.k34 += k * wp.outer(b_p, b_q)
    out.k44 += k * wp.outer(b_q, b_q)
    return out


@wp.func
def add_bending(band: BandMatrix, axes: RingAxes, factor: wp.mat33, rigidity: float, r: int, w: int) -> BandMatrix:
    """Add the bound on the bending along the colon: springs on mixtures of widening and flattening.

    Args:
        band: Matrix of the band.
        axes: Directions of the rings.
        factor: Its columns are the mixtures [1/m].
        rigidity: Flexural rigidity [N m].
        r: Ring of the band.
        w: World.
    """
    p = axes.p[r, w]
    q = axes.q[r, w]
    next_p = axes.p[r + 1, w]
    next_q = axes.q[r + 1, w]
    out = band
    for k in range(3):
        along = factor[0, k] + factor[1, k]
        across = factor[0, k] - factor[1, k]
        mixed = factor[2, k]
        out = add_strain_difference(
            out,
            rigidity,
            along * p + mixed * q,
            across * q + mixed * p,
            along * next_p + mixed * next_q,
            across * next_q + mixed * next_p,
        )
    return out


@wp.func
def write_block(blocks: wp.array4d[float], r: int, k: int, n: int, w: int, block: wp.mat33):
    """Write the block between the vectors ``k`` and ``n`` of ring ``r``."""
    for i in range(3):
        for j in range(3):
            blocks[r, w, 3 * k + i, 3 * n + j] = block[i, j]


@wp.func
def write_symmetric(blocks: wp.array4d[float], r: int, k: int, n: int, w: int, block: wp.mat33):
    """Write the blocks between the vectors ``k`` and ``n`` of ring ``r``, and between ``n`` and ``k``."""
    write_block(blocks, r, k, n, w, block)
    write_block(blocks, r, n, k, w, wp.transpose(block))


def band_kernel(elements_type: type, add_element: wp.Function) -> wp.Kernel:
    """Make the kernel that measures the bands' stiffness, for one kind of elements.

    Args:
        elements_type: Struct of the elements.
        add_element: Adds an element to a band's matrix, at the present positions; takes matrix, elements, rings,
            positions, element, ring, world and moduli.
    """

    @wp.kernel(module="unique")
    def measure_bands(
        x: wp.array2d[wp.vec3],
        elements: elements_type,
        rings: Rings,
        axes: RingAxes,
        tissue: Tissue,
        own: wp.array4d[float],
        behind: wp.array4d[float],
        upper: wp.array4d[float],
    ):
        """Measure the stiffness of every band. Launch (R - 1, W).

        Args:
            x: Positions [m], shape (V, W).
            elements: Elements of all patients.
            rings: Rings of all patients.
            axes: Directions of the rings.
            tissue: Values of each world.
            own: Blocks of each ring by its band [N/m], shape (R, W, M, M); written.
            behind: Blocks of each ring by the band before [N/m], shape (R, W, M, M); written.
            upper: Blocks from each ring to the next [N/m], shape (R, W, M, M); written.
        """
        r, w = wp.tid()
        band = BandMatrix()
        for e in range(rings.band_start[r], rings.band_start[r + 1]):
            band = add_element(band, elements, rings, x, rings.band[e], r, w, tissue.moduli[w])
        band = add_bending(band, axes, rings.bending[r, rings.patient[w]], tissue.moduli[w][2], r, w)
        write_symmetric(own, r, 0, 0, w, band.k00)
        write_symmetric(own, r, 0, 1, w, band.k01)
        write_symmetric(own, r, 0, 2, w, band.k02)
        write_symmetric(own, r, 1, 1, w, band.k11)
        write_symmetric(own, r, 1, 2, w, band.k12)
        write_symmetric(own, r, 2, 2, w, band.k22)
        write_symmetric(behind, r + 1, 0, 0, w, band.k00)
        write_symmetric(behind, r + 1, 0, 1, w, -band.k03)
        write_symmetric(behind, r + 1, 0, 2, w, -band.k04)
        write_symmetric(behind, r + 1, 1, 1, w, band.k33)
        write_symmetric(behind, r + 1, 1, 2, w, band.k34)
        write_symmetric(behind, r + 1, 2, 2, w, band.k44)
        write_block(upper, r, 0, 0, w, -band.k00)
        write_block(upper, r, 0, 1, w, band.k03)
        write_block(upper, r, 0, 2, w, band.k04)
        write_block(upper, r, 1, 0, w, -wp.transpose(band.k01))
        write_block(upper, r, 1, 1, w, band.k13)
        write_block(upper, r, 1, 2, w, band.k14)
        write_block(upper, r, 2, 0, w, -wp.transpose(band.k02))
        write_block(upper, r, 2, 1, w, band.k23)
        write_block(upper, r, 2, 2, w, band.k24)

    return measure_bands
