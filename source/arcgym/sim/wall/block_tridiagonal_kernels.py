# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Block-tridiagonal systems by block Cholesky, row after row (Golub and Van Loan, Matrix Computations, section 4.5).

Row r reads U_{r-1}^T x_{r-1} + D_r x_r + U_r x_{r+1} = b_r. With S_r = D_r - W_{r-1}^T W_{r-1} = L_r L_r^T and
W_r = L_r^-1 U_r, the way down gives y_r = L_r^-1 (b_r - W_{r-1}^T y_{r-1}) and the way back
x_r = L_r^-T (y_r - W_r x_{r+1}). One thread a world; on a GPU :mod:`.block_tridiagonal_cuda_kernels` is faster.

Blocks have the shape (R, W, M, M), right-hand sides (R, W, M): R rows, W worlds, M unknowns of a row.
"""

import warp as wp

from arcgym.sim.wall.ring_modes import MODES as RING_MODES
from arcgym.utils import warp_setup  # noqa: F401

MODES = wp.constant(RING_MODES)
"""Unknowns of a ring, see :data:`arcgym.sim.wall.ring_modes.MODES`."""
SMALLEST_PIVOT = wp.constant(1.0e-6)
"""Least pivot of a factor, so that rounding alone never takes the root of a negative number [N/m]."""
Unknowns = wp.types.vector(length=RING_MODES, dtype=float)
Block = wp.types.matrix(shape=(RING_MODES, RING_MODES), dtype=float)


@wp.func
def subtract_row_before(r: int, w: int, diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Replace D_r by S_r = D_r - W^T W and b_r by b_r - W^T y, with W and y of row ``r`` - 1."""
    for a in range(diagonal.shape[2]):
        own = Unknowns()
        b = rhs[r, w, a]
        for c in range(MODES):
            own[c] = diagonal[r, w, a, c]
        for k in range(MODES):
            share = upper[r - 1, w, k, a]
            b -= share * rhs[r - 1, w, k]
            for c in range(MODES):
                own[c] = own[c] - share * upper[r - 1, w, k, c]
        for c in range(MODES):
            diagonal[r, w, a, c] = own[c]
        rhs[r, w, a] = b


@wp.func
def factor(r: int, w: int, diagonal: wp.array4d[float]):
    """Replace the lower half of S_r by its Cholesky factor L_r, with inverted diagonal."""
    out = Block()
    for j in range(MODES):
        d = diagonal[r, w, j, j]
        for k in range(j):
            d -= out[j, k] * out[j, k]
        d = 1.0 / wp.sqrt(wp.max(d, SMALLEST_PIVOT))
        diagonal[r, w, j, j] = d
        for i in range(j + 1, MODES):
            e = diagonal[r, w, i, j]
            for k in range(j):
                e -= out[i, k] * out[j, k]
            e = e * d
            out[i, j] = e
            diagonal[r, w, i, j] = e


@wp.func
def eliminate(r: int, w: int, diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Replace U_r by W_r = L_r^-1 U_r and b_r by y_r = L_r^-1 b_r."""
    for j in range(diagonal.shape[2]):
        row = Unknowns()
        s = rhs[r, w, j]
        for c in range(MODES):
            row[c] = upper[r, w, j, c]
        for k in range(j):
            share = diagonal[r, w, j, k]
            s -= share * rhs[r, w, k]
            for c in range(MODES):
                row[c] = row[c] - share * upper[r, w, k, c]
        d = diagonal[r, w, j, j]
        rhs[r, w, j] = s * d
        for c in range(MODES):
            upper[r, w, j, c] = row[c] * d


@wp.func
def substitute_back(r: int, w: int, diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Replace y_r by x_r = L_r^-T (y_r - W_r x_{r+1})."""
    x = Unknowns()
    for j in range(MODES):
        x[j] = rhs[r, w, j]
    if r + 1 < diagonal.shape[0]:
        for c in range(MODES):
            after = rhs[r + 1, w, c]
            for j in range(MODES):
                x[j] = x[j] - upper[r, w, j, c] * after
    for back in range(MODES):
        j = MODES - 1 - back
        s = x[j]
        for k in range(j + 1, MODES):
            s -= diagonal[r, w, k, j] * x[k]
        x[j] = s * diagonal[r, w, j, j]
    for j in range(MODES):
        rhs[r, w, j] = x[j]


@wp.kernel
def eliminate_rows(
    first: int, count: int, diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]
):
    """Go some rows down every world's system. Launch (W,).

    Args:
        first: First of the rows, those before it having been done.
        count: How many.
        diagonal: Blocks D, shape (R, W, M, M); the factors L afterwards.
        upper: Couplings U to the next row, shape (R, W, M, M); W afterwards.
        rhs: Right-hand side b, shape (R, W, M); y afterwards.
    """
    w = wp.tid()
    for r in range(first, first + count):
        if r > 0:
            subtract_row_before(r, w, diagonal, upper, rhs)
        factor(r, w, diagonal)
        eliminate(r, w, diagonal, upper, rhs)


@wp.kernel
def substitute_rows(diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Go back up every world's system, after ``eliminate_rows``. Launch (W,).

    Args:
        diagonal: Its factors L, shape (R, W, M, M).
        upper: Its blocks W, shape (R, W, M, M).
        rhs: y, shape (R, W, M); the solution x afterwards.
    """
    w = wp.tid()
    rows = diagonal.shape[0]
    for back in range(rows):
        substitute_back(rows - 1 - back, w, diagonal, upper, rhs)


@wp.kernel
def solve_again(diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Solve every world's system for another right-hand side, after ``eliminate_rows``. Launch (W,).

    Args:
        diagonal: Its factors L, shape (R, W, M, M).
        upper: Its blocks W, shape (R, W, M, M).
        rhs: Right-hand side b, shape (R, W, M); the solution x afterwards.
    """
    w = wp.tid()
    rows = diagonal.shape[0]
    for r in range(rows):
        y = Unknowns()
        for j in range(MODES):
            s = rhs[r, w, j]
            if r > 0:
                for k in range(MODES):
                    s -= upper[r - 1, w, k, j] * rhs[r - 1, w, k]
            for k in range(j):
                s -= diagonal[r, w, j, k] * y[k]
            y[j] = s * diagonal[r, w, j, j]
        for j in range(MODES):
            rhs[r, w, j] = y[j]
    for back in range(rows):
        substitute_back(rows - 1 - back, w, diagonal, upper, rhs)
