# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Block-tridiagonal systems by cyclic reduction (Golub and Van Loan, Matrix Computations, section 4.5).

Row i reads U_{i-h}^T x_{i-h} + D_i x_i + U_i x_{i+h} = b_i, with the distance h of neighbours doubling from level to
level. A level eliminates every odd row (i = h, 3h, 5h, ...), all at once; the even rows are the next level's system.
Blocks have the shape (R, M, M, W), right-hand sides (R, M, W): neighbouring threads work on neighbouring worlds.
"""

import warp as wp

from arcgym.sim.wall.ring_modes import MODES as RING_MODES
from arcgym.utils import warp_setup  # noqa: F401

MODES = wp.constant(RING_MODES)
Unknowns = wp.types.vector(length=RING_MODES, dtype=float)
Block = wp.types.matrix(shape=(RING_MODES, RING_MODES), dtype=float)


@wp.kernel
def factor_odd(first: int, step: int, diagonal: wp.array4d[float]):
    """Replace each odd row's block by its Cholesky factor, with inverted diagonal. Launch (odd rows, W).

    Args:
        first: First odd row.
        step: Distance to the next one.
        diagonal: Blocks, shape (R, M, M, W); changed in place.
    """
    m, w = wp.tid()
    r = first + m * step
    out = Block()
    for j in range(MODES):
        d = diagonal[r, j, j, w]
        for k in range(j):
            d -= out[j, k] * out[j, k]
        d = 1.0 / wp.sqrt(wp.max(d, 1.0e-6))
        diagonal[r, j, j, w] = d
        for i in range(j + 1, MODES):
            e = diagonal[r, i, j, w]
            for k in range(j):
                e -= out[i, k] * out[j, k]
            e = e * d
            out[i, j] = e
            diagonal[r, i, j, w] = e


@wp.func
def forward_solve(lower: wp.array4d[float], r: int, w: int, b: Unknowns) -> Unknowns:
    """Solve ``lower[r] x = b`` in world ``w``; the diagonal holds its inverse."""
    out = Unknowns()
    for j in range(MODES):
        s = b[j]
        for k in range(j):
            s -= lower[r, j, k, w] * out[k]
        out[j] = s * lower[r, j, j, w]
    return out


@wp.func
def backward_solve(lower: wp.array4d[float], r: int, w: int, b: Unknowns) -> Unknowns:
    """Solve ``lower[r]^T x = b`` in world ``w``; the diagonal holds its inverse."""
    out = Unknowns()
    for back in range(MODES):
        j = MODES - 1 - back
        s = b[j]
        for k in range(j + 1, MODES):
            s -= lower[r, k, j, w] * out[k]
        out[j] = s * lower[r, j, j, w]
    return out


@wp.kernel
def eliminate_odd(
    h: int,
    diagonal: wp.array4d[float],
    upper: wp.array4d[float],
    left: wp.array4d[float],
    right: wp.array4d[float],
    rhs: wp.array3d[float],
):
    """Compute columns of P = L^-1 U_{j-h}^T and Q = L^-1 U_j, and y = L^-1 b. Launch (odd rows, 2 M + 1, W).

    Args:
        h: Distance of neighbours.
        diagonal: Factors L of the odd rows, shape (R, M, M, W).
        upper: Couplings U, shape (R, M, M, W).
        left: P, shape (R, M, M, W); written.
        right: Q, shape (R, M, M, W); written.
        rhs: Right-hand side, y in the odd rows afterwards, shape (R, M, W).
    """
    m, c, w = wp.tid()
    r = h * (2 * m + 1)
    b = Unknowns()
    for k in range(MODES):
        if c < MODES:
            b[k] = upper[r - h, c, k, w]
        elif c < 2 * MODES:
            if r + h < diagonal.shape[0]:
                b[k] = upper[r, k, c - MODES, w]
        else:
            b[k] = rhs[r, k, w]
    x = forward_solve(diagonal, r, w, b)
    for k in range(MODES):
        if c < MODES:
            left[r, k, c, w] = x[k]
        elif c < 2 * MODES:
            right[r, k, c - MODES, w] = x[k]
        else:
            rhs[r, k, w] = x[k]


@wp.kernel
def reduce_even(
    h: int,
    left: wp.array4d[float],
    right: wp.array4d[float],
    diagonal: wp.array4d[float],
    upper: wp.array4d[float],
    rhs: wp.array3d[float],
):
    """Compute row ``a`` of each even row's new block, coupling and right-hand side. Launch (even rows, M, W).

    Args:
        h: Distance of neighbours.
        left: P, shape (R, M, M, W).
        right: Q, shape (R, M, M, W).
        diagonal: Blocks, shape (R, M, M, W); changed in place.
        upper: Couplings, shape (R, M, M, W); changed in place.
        rhs: Right-hand side, shape (R, M, W); changed in place.
    """
    m, a, w = wp.tid()
    r = 2 * h * m
    rows = diagonal.shape[0]
    before = r - h
    after = r + h
    own = Unknowns()
    new = Unknowns()
    for c in range(MODES):
        own[c] = diagonal[r, a, c, w]
    b = rhs[r, a, w]
    if before >= 0:
        for k in range(MODES):
            q = right[before, k, a, w]
            b -= q * rhs[before, k, w]
            for c in range(MODES):
                own[c] = own[c] - q * right[before, k, c, w]
    if after < rows:
        for k in range(MODES):
            p = left[after, k, a, w]
            b -= p * rhs[after, k, w]
            for c in range(MODES):
                own[c] = own[c] - p * left[after, k, c, w]
                new[c] = new[c] - p * right[after, k, c, w]
    for c in range(MODES):
        diagonal[r, a, c, w] = own[c]
        upper[r, a, c, w] = new[c]
    rhs[r, a, w] = b


@wp.kernel
def solve_root(diagonal: wp.array4d[float], rhs: wp.array3d[float]):
    """Solve the one row that is left, its block already factored, into ``rhs``. Launch (W,)."""
    w = wp.tid()
    b = Unknowns()
    for k in range(MODES):
        b[k] = rhs[0, k, w]
    x = backward_solve(diagonal, 0, w, forward_solve(diagonal, 0, w, b))
    for k in range(MODES):
        rhs[0, k, w] = x[k]


@wp.kernel
def back_substitute(
    h: int,
    diagonal: wp.array4d[float],
    left: wp.array4d[float],
    right: wp.array4d[float],
    rhs: wp.array3d[float],
):
    """Solve the odd rows from their even neighbours: x = L^-T (y - P x_{j-h} - Q x_{j+h}). Launch (odd rows, W).

    Args:
        h: Distance of neighbours.
        diagonal: Factors L of the odd rows, shape (R, M, M, W).
        left: P, shape (R, M, M, W).
        right: Q, shape (R, M, M, W).
        rhs: y in the odd and x in the even rows, shape (R, M, W); x in all rows afterwards.
    """
    m, w = wp.tid()
    r = h * (2 * m + 1)
    y = Unknowns()
    for k in range(MODES):
        y[k] = rhs[r, k, w]
    for c in range(MODES):
        before = rhs[r - h, c, w]
        for k in range(MODES):
            y[k] = y[k] - left[r, k, c, w] * before
    if r + h < rhs.shape[0]:
        for c in range(MODES):
            after = rhs[r + h, c, w]
            for k in range(MODES):
                y[k] = y[k] - right[r, k, c, w] * after
    x = backward_solve(diagonal, r, w, y)
    for k in range(MODES):
        rhs[r, k, w] = x[k]
