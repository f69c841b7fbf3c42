# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Loads of the links, one row of 32 floats each, as the warp reads them that solves a chain on a GPU.

Of a load, see :class:`.scope_kernels.LinkLoads`, 27 numbers differ. A row holds them in the order of :class:`LoadSum`,
then five that nobody reads: it is a line of memory, which eight neighboring threads write in one go.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_vote_kernels import GROUP

FOURS = 8
"""Vectors of four that a row takes; one for each of the ``GROUP`` threads that add up its load."""
assert FOURS == GROUP


@wp.struct
class LoadRows:
    """Loads of all links; a row is valid where its link is ``loaded``."""

    fours: wp.array[wp.vec4]  # shape (W*L*FOURS,)
    loaded: wp.array[int]  # 1 or 0, shape (W*L,)


@wp.struct
class LoadSum:
    """Load of a link about its center of mass: the force on what it touches and its growth by acceleration."""

    force: wp.vec3  # if the link keeps its velocity [N]
    ll_diagonal: wp.vec3  # force by linear acceleration [kg]: xx, yy, zz
    ll_beside: wp.vec3  # yz, zx, xy
    la: wp.mat33  # force by angular acceleration [kg m]
    torque: wp.vec3  # as ``force`` [N m]
    aa_diagonal: wp.vec3  # torque by angular acceleration [kg m^2]: xx, yy, zz
    aa_beside: wp.vec3  # yz, zx, xy


@wp.func
def products_beside(a: wp.vec3, b: wp.vec3) -> wp.vec3:
    """Return the elements yz, zx and xy of a symmetric outer product of ``a`` and ``b``."""
    return wp.vec3(a[1] * b[2], a[2] * b[0], a[0] * b[1])


@wp.func
def with_push(total: LoadSum, force: wp.vec3, normal: wp.vec3, more: float, across: float, r: wp.vec3) -> LoadSum:
    """Return a load and that of a point with the inertia ``across`` and, along ``normal``, ``more`` [kg].

    Args:
        total: Load so far.
        force: Force at the point [N].
        normal: Unit vector.
        more: Inertia along it less that across it [kg].
        across: Inertia across it [kg].
        r: From the center of mass to the point [m].
    """
    arm = wp.cross(r, normal)
    inertia = more * normal
    turned = more * arm
    lever = across * r
    out = total
    out.force += force
    out.ll_diagonal += wp.cw_mul(inertia, normal) + wp.vec3(across)
    out.ll_beside += products_beside(inertia, normal)
    out.la += wp.outer(inertia, arm) - wp.skew(lever)
    out.torque += wp.cross(r, force)
    out.aa_diagonal += wp.cw_mul(turned, arm) + (wp.vec3(wp.dot(lever, r)) - wp.cw_mul(lever, r))
    out.aa_beside += products_beside(turned, arm) - products_beside(lever, r)
    return out


@wp.func_native("""
    float all[32] = {
        sum.force[0], sum.force[1], sum.force[2],
        sum.ll_diagonal[0], sum.ll_diagonal[1], sum.ll_diagonal[2],
        sum.ll_beside[0], sum.ll_beside[1], sum.ll_beside[2],
        sum.la.data[0][0], sum.la.data[0][1], sum.la.data[0][2],
        sum.la.data[1][0], sum.la.data[1][1], sum.la.data[1][2],
        sum.la.data[2][0], sum.la.data[2][1], sum.la.data[2][2],
        sum.torque[0], sum.torque[1], sum.torque[2],
        sum.aa_diagonal[0], sum.aa_diagonal[1], sum.aa_diagonal[2],
        sum.aa_beside[0], sum.aa_beside[1], sum.aa_beside[2],
        0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
#if defined(__CUDA_ARCH__)
    // a thread keeps half of what it has, and gives the other half to one that keeps that: at last, four numbers each
    #pragma unroll
    for (int n = 0; n < 3; ++n) {
        const int half = 16 >> n, apart = 4 >> n;
        const bool upper = (lane & apart) != 0;
        #pragma unroll
        for (int i = 0; i < 16; ++i)
            if (i < half) {
                const float kept = upper ? all[half + i] : all[i], given = upper ? all[i] : all[half + i];
                all[i] = kept + __shfl_xor_sync(0xffffffffu, given, apart);
            }
    }
    if (!valid) return;
    float4* const to = (float4*)(rows.fours.data) + (size_t)row * 8 + lane;
    const float4 before = more ? *to : make_float4(0.0f, 0.0f, 0.0f, 0.0f);
    *to = make_float4(before.x + all[0], before.y + all[1], before.z + all[2], before.w + all[3]);
#else
    if (!valid) return;
    float* const to = (float*)(rows.fours.data + (size_t)row * 8);
    for (int i = 0; i < 32; ++i) to[i] = all[i] + (more ? to[i] : 0.0f);
#endif
""")
def write_row(sum: LoadSum, row: int, lane: int, valid: bool, more: bool, rows: LoadRows):
    """Write the sum over ``GROUP`` neighboring threads to a row if it is ``valid``, or add it where there is ``more``.

    All threads of the warp have to call it; on a CPU each is one of its own.

    Args:
        sum: What the thread has added up.
        row: Row of the link.
        lane: Number of the thread among the ``GROUP``.
        valid: Whether to write; the same for all of the ``GROUP``.
        more: Whether the row holds a part of the sum already.
        rows: Loads; written.
    """
    ...
