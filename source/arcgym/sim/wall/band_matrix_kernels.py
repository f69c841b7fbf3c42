# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Matrix of a band of the wall, see :mod:`.band_kernels`: what adds to it, and where it is kept.

Block by block and not in loops: a matrix that loops index is kept out of the registers of a CPU, where it then takes
twice the time.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.on_cpu_kernels import on_cpu

ENTRIES = 15
"""Unknowns of a band: the entries of its five vectors."""


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
def add_edge(band: BandMatrix, b: Five, stiffness: wp.mat33) -> BandMatrix:
    """Add the symmetric ``stiffness`` [N/m] of an edge along which the fields differ by ``b``."""
    out = band
    out.k00 += (b[0] * b[0]) * stiffness
    out.k01 += (b[0] * b[1]) * stiffness
    out.k11 += (b[1] * b[1]) * stiffness
    out.k02 += (b[0] * b[2]) * stiffness
    out.k12 += (b[1] * b[2]) * stiffness
    out.k22 += (b[2] * b[2]) * stiffness
    out.k03 += (b[0] * b[3]) * stiffness
    out.k13 += (b[1] * b[3]) * stiffness
    out.k23 += (b[2] * b[3]) * stiffness
    out.k33 += (b[3] * b[3]) * stiffness
    out.k04 += (b[0] * b[4]) * stiffness
    out.k14 += (b[1] * b[4]) * stiffness
    out.k24 += (b[2] * b[4]) * stiffness
    out.k34 += (b[3] * b[4]) * stiffness
    out.k44 += (b[4] * b[4]) * stiffness
    return out


@wp.func
def add_pair(band: BandMatrix, a: Five, b: Five, stiffness: wp.mat33) -> BandMatrix:
    """Add the ``stiffness`` [N/m] between two corners where the fields are ``a`` and ``b``."""
    out = band
    back = wp.transpose(stiffness)
    out.k00 += (a[0] * b[0]) * stiffness + (b[0] * a[0]) * back
    out.k01 += (a[0] * b[1]) * stiffness + (b[0] * a[1]) * back
    out.k11 += (a[1] * b[1]) * stiffness + (b[1] * a[1]) * back
    out.k02 += (a[0] * b[2]) * stiffness + (b[0] * a[2]) * back
    out.k12 += (a[1] * b[2]) * stiffness + (b[1] * a[2]) * back
    out.k22 += (a[2] * b[2]) * stiffness + (b[2] * a[2]) * back
    out.k03 += (a[0] * b[3]) * stiffness + (b[0] * a[3]) * back
    out.k13 += (a[1] * b[3]) * stiffness + (b[1] * a[3]) * back
    out.k23 += (a[2] * b[3]) * stiffness + (b[2] * a[3]) * back
    out.k33 += (a[3] * b[3]) * stiffness + (b[3] * a[3]) * back
    out.k04 += (a[0] * b[4]) * stiffness + (b[0] * a[4]) * back
    out.k14 += (a[1] * b[4]) * stiffness + (b[1] * a[4]) * back
    out.k24 += (a[2] * b[4]) * stiffness + (b[2] * a[4]) * back
    out.k34 += (a[3] * b[4]) * stiffness + (b[3] * a[4]) * back
    out.k44 += (a[4] * b[4]) * stiffness + (b[4] * a[4]) * back
    return out


@wp.func
def add_own_edge(band: BandMatrix, a: wp.vec2, b: Five, stiffness: wp.mat33, between: wp.mat33) -> BandMatrix:
    """Add the stiffness of an edge within the own ring, and that ``between`` it and any edge with the fields ``b``.

    ``a`` is how far (p, q) of the edge's ends differ; stiffness in N/m, the first symmetric.
    """
    out = band
    back = wp.transpose(between)
    both = between + back
    out.k01 += (a[0] * b[0]) * back
    out.k11 += (a[0] * a[0]) * stiffness + (a[0] * b[1]) * both
    out.k12 += (a[0] * a[1]) * stiffness + (a[0] * b[2]) * between + (a[1] * b[1]) * back
    out.k13 += (a[0] * b[3]) * between
    out.k14 += (a[0] * b[4]) * between
    out.k02 += (a[1] * b[0]) * back
    out.k22 += (a[1] * a[1]) * stiffness + (a[1] * b[2]) * both
    out.k23 += (a[1] * b[3]) * between
    out.k24 += (a[1] * b[4]) * between
    return out


@wp.func
def add_next_edge(band: BandMatrix, a: wp.vec2, b: Five, stiffness: wp.mat33, between: wp.mat33) -> BandMatrix:
    """Add the stiffness of an edge within the next ring, and that ``between`` it and any edge with the fields ``b``.

    ``a`` is how far (p, q) of the edge's ends differ; stiffness in N/m, the first symmetric.
    """
    out = band
    back = wp.transpose(between)
    both = between + back
    out.k03 += (a[0] * b[0]) * back
    out.k13 += (a[0] * b[1]) * back
    out.k23 += (a[0] * b[2]) * back
    out.k33 += (a[0] * a[0]) * stiffness + (a[0] * b[3]) * both
    out.k34 += (a[0] * a[1]) * stiffness + (a[0] * b[4]) * between + (a[1] * b[3]) * back
    out.k04 += (a[1] * b[0]) * back
    out.k14 += (a[1] * b[1]) * back
    out.k24 += (a[1] * b[2]) * back
    out.k44 += (a[1] * a[1]) * stiffness + (a[1] * b[4]) * both
    return out


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
def write_upper(bands: wp.array4d[float], r: int, k: int, n: int, w: int, block: wp.mat33):
    """Write the block between the vectors ``k`` and ``n`` of the band of ring ``r``, of a symmetric one half."""
    for i in range(3):
        for j in range(3):
            if k < n or i <= j:
                bands[r, 3 * k + i, 3 * n + j, w] = block[i, j]


_MIRROR = """
#if !defined(__CUDA_ARCH__)
    float* const band = wp::address(bands, r, 0, 0, w);
    const size_t row = bands.strides[1] / sizeof(*band), column = bands.strides[2] / sizeof(*band);
    #pragma clang loop unroll(disable)
    for (size_t i = 0; i < ENTRIES; ++i)
        #pragma clang loop unroll(disable)
        for (size_t j = i + 1; j < ENTRIES; ++j) band[j * row + i * column] = band[i * row + j * column];
#endif
""".replace("ENTRIES", str(ENTRIES))


@wp.func_native(_MIRROR)
def mirror_band(bands: wp.array4d[float], r: int, w: int):
    """Copy the upper half of the band of ring ``r`` to its lower one on a CPU, which reads whole rows faster.

    From memory, in loops: written twice when they are found, the numbers would be rounded elsewhere.
    """
    ...


@wp.func
def write_band(bands: wp.array4d[float], r: int, w: int, band: BandMatrix):
    """Write the band of ring ``r`` of world ``w``; ``bands`` as in ``band_entry``."""
    write_upper(bands, r, 0, 0, w, band.k00)
    write_upper(bands, r, 0, 1, w, band.k01)
    write_upper(bands, r, 0, 2, w, band.k02)
    write_upper(bands, r, 0, 3, w, band.k03)
    write_upper(bands, r, 0, 4, w, band.k04)
    write_upper(bands, r, 1, 1, w, band.k11)
    write_upper(bands, r, 1, 2, w, band.k12)
    write_upper(bands, r, 1, 3, w, band.k13)
    write_upper(bands, r, 1, 4, w, band.k14)
    write_upper(bands, r, 2, 2, w, band.k22)
    write_upper(bands, r, 2, 3, w, band.k23)
    write_upper(bands, r, 2, 4, w, band.k24)
    write_upper(bands, r, 3, 3, w, band.k33)
    write_upper(bands, r, 3, 4, w, band.k34)
    write_upper(bands, r, 4, 4, w, band.k44)
    mirror_band(bands, r, w)


@wp.func
def band_entry(bands: wp.array4d[float], r: int, a: int, b: int, w: int) -> float:
    """Return the stiffness between two unknowns of a band [N/m].

    Args:
        bands: All bands [N/m], worlds beside each other, on a GPU their upper halves, shape (R, 15, 15, W).
        r: Ring of the band.
        a: Unknown: entry ``a % 3`` of vector ``a // 3``.
        b: The other.
        w: World.
    """
    if on_cpu():
        return bands[r, a, b, w]
    return bands[r, wp.min(a, b), wp.max(a, b), w]
