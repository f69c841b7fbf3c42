# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Block-tridiagonal systems of 9x9 blocks by cyclic reduction (Golub and Van Loan, Matrix Computations, section 4.5).

Row i reads U_{i-h}^T x_{i-h} + D_i x_i + U_i x_{i+h} = b_i, with the distance h of neighbours doubling from level to
level. A level eliminates every odd row (i = h, 3h, 5h, ...), all at once; the even rows are the next level's system.
Launch dimensions: W worlds, then the level's odd or even rows.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

Block = wp.types.matrix(shape=(9, 9), dtype=float)
Unknowns = wp.types.vector(length=9, dtype=float)


@wp.kernel
def factor_odd(first: int, step: int, diagonal: wp.array2d(dtype=Block)):
    """Cholesky factor of each odd row's block, in place (lower triangle). Launch (W, odd rows)."""
    w, m = wp.tid()
    r = first + m * step
    a = diagonal[w, r]
    out = Block()
    for j in range(9):
        d = a[j, j]
        for k in range(j):
            d -= out[j, k] * out[j, k]
        d = wp.sqrt(wp.max(d, 1.0e-6))
        out[j, j] = d
        for i in range(j + 1, 9):
            e = a[i, j]
            for k in range(j):
                e -= out[i, k] * out[j, k]
            out[i, j] = e / d
    diagonal[w, r] = out


@wp.func
def forward_solve(lower: Block, b: Unknowns) -> Unknowns:
    """Solve ``lower x = b``."""
    out = Unknowns()
    for j in range(9):
        s = b[j]
        for k in range(j):
            s -= lower[j, k] * out[k]
        out[j] = s / lower[j, j]
    return out


@wp.func
def backward_solve(lower: Block, b: Unknowns) -> Unknowns:
    """Solve ``lower^T x = b``."""
    out = Unknowns()
    for back in range(9):
        j = 8 - back
        s = b[j]
        for k in range(j + 1, 9):
            s -= lower[k, j] * out[k]
        out[j] = s / lower[j, j]
    return out


@wp.kernel
def eliminate_odd(
    h: int,
    diagonal: wp.array2d(dtype=Block),
    upper: wp.array4d(dtype=float),
    left: wp.array4d(dtype=float),
    right: wp.array4d(dtype=float),
    rhs: wp.array3d(dtype=float),
):
    """Columns of P = L^-1 U_{j-h}^T and Q = L^-1 U_j, and y = L^-1 b. Launch (W, odd rows, 19)."""
    w, m, c = wp.tid()
    r = h * (2 * m + 1)
    b = Unknowns()
    for k in range(9):
        if c < 9:
            b[k] = upper[w, r - h, c, k]
        elif c < 18:
            if r + h < diagonal.shape[1]:
                b[k] = upper[w, r, k, c - 9]
        else:
            b[k] = rhs[w, r, k]
    x = forward_solve(diagonal[w, r], b)
    for k in range(9):
        if c < 9:
            left[w, r, k, c] = x[k]
        elif c < 18:
            right[w, r, k, c - 9] = x[k]
        else:
            rhs[w, r, k] = x[k]


@wp.kernel
def reduce_even(
    h: int,
    left: wp.array4d(dtype=float),
    right: wp.array4d(dtype=float),
    diagonal: wp.array4d(dtype=float),
    upper: wp.array4d(dtype=float),
    rhs: wp.array3d(dtype=float),
):
    """Row ``a`` of each even row's new block, coupling and right-hand side. Launch (W, even rows, 9)."""
    w, m, a = wp.tid()
    r = 2 * h * m
    rows = diagonal.shape[1]
    before = r - h
    after = r + h
    b = rhs[w, r, a]
    for c in range(9):
        d = diagonal[w, r, a, c]
        u = float(0.0)
        if before >= 0:
            for k in range(9):
                d -= right[w, before, k, a] * right[w, before, k, c]
        if after < rows:
            for k in range(9):
                p = left[w, after, k, a]
                d -= p * left[w, after, k, c]
                u -= p * right[w, after, k, c]
        diagonal[w, r, a, c] = d
        upper[w, r, a, c] = u
    if before >= 0:
        for k in range(9):
            b -= right[w, before, k, a] * rhs[w, before, k]
    if after < rows:
        for k in range(9):
            b -= left[w, after, k, a] * rhs[w, after, k]
    rhs[w, r, a] = b


@wp.kernel
def solve_root(diagonal: wp.array2d(dtype=Block), rhs: wp.array2d(dtype=Unknowns)):
    """The one row that is left, its block already factored. Launch (W,)."""
    w = wp.tid()
    rhs[w, 0] = backward_solve(diagonal[w, 0], forward_solve(diagonal[w, 0], rhs[w, 0]))


@wp.kernel
def back_substitute(
    h: int,
    diagonal: wp.array2d(dtype=Block),
    left: wp.array2d(dtype=Block),
    right: wp.array2d(dtype=Block),
    rhs: wp.array2d(dtype=Unknowns),
):
    """Odd rows from their even neighbours: x = L^-T (y - P x_{j-h} - Q x_{j+h}). Launch (W, odd rows)."""
    w, m = wp.tid()
    r = h * (2 * m + 1)
    y = rhs[w, r] - left[w, r] * rhs[w, r - h]
    if r + h < rhs.shape[1]:
        y -= right[w, r] * rhs[w, r + h]
    rhs[w, r] = backward_solve(diagonal[w, r], y)
