# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Block-tridiagonal systems on a GPU: what :mod:`.block_tridiagonal_kernels` does, by two warps a world.

One warp works its way from the first row to the middle, the other from the last; the first solves the middle row, and
both go back. A warp holds a row of the system in registers, a column a lane: the M columns of S, the M of U, and b. So
a column of the Cholesky factor, of W = L^-1 U and of y = L^-1 b take one multiplication and, for each row below, one
exchange and one fused product in all lanes at once. Another right-hand side takes one lane more on the way down; on the
way back the lanes of U, which are free then, find its solution beside those of S.

Of a row of the second warp that is kept, see ``kept_rows_kernels``, y alone is missing: each of M lanes has a column of
L and one of the W before, and takes as many exchanges as on the way back.
"""

import warp as wp

from arcgym.sim.wall.block_tridiagonal_kernels import SMALLEST_PIVOT
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.ring_modes import MODES
from arcgym.utils import warp_setup  # noqa: F401

THREADS = 64
"""Threads a world, which are one block: two warps."""

_SOLVE = """
#if defined(__CUDA_ARCH__)
    constexpr int M = MODES;  // columns 0 to M - 1 of S, M to 2 M - 1 of U, 2 M is b, 2 M + 1 the other b
    constexpr int SIDES = RIGHT_HAND_SIDES;
    constexpr int PADDED = (M + 3) / 4 * 4;
    constexpr unsigned ALL = 0xffffffffu;
    static_assert(2 * M + SIDES <= 32, "a row of the system has to fit a warp");
    __shared__ __align__(16) float shared[2][M * PADDED];  // W of the row at hand, a column after the other
    __shared__ float above[M][M + SIDES];  // what the last rows take off the middle one
    __shared__ float solved[SIDES][M];  // x of the middle row

    const int lane = thread % 32, side = thread / 32;
    const bool in_s = lane < M, in_u = lane >= M && lane < 2 * M, in_other = SIDES == 2 && lane == 2 * M + 1;
    const bool in_b = lane == 2 * M || in_other;
    const int rows = diagonal.shape[0];
#if KEEPS
    const int before = kept.middle.data[world];
    const int light = before < 0 ? rows : wp::max(kept.first.data[world], before + 1);  // first_kept
    // where the warps meet at the same time, if a kept row takes a third of another on the way down, as on the way back
    const int middle = wp::min((14 * rows + 13 * light) / 54, light - 1);
#else
    const int middle = rows / 2;
#endif
    const int step = side == 0 ? 1 : -1, count = side == 0 ? middle : rows - 1 - middle;
    const long long block = (long long)diagonal.shape[1] * M * M, row = (long long)diagonal.shape[1] * M;
    float* const d = diagonal.data + (long long)world * M * M;
    float* const u = upper.data + (long long)world * M * M - side * block;  // the last rows couple with those before
    float* const b = (in_other ? OTHER.data : rhs.data) + (long long)world * M;
    float* column = in_s ? d + lane : b;  // this lane's, of the first row; the last rows' U is transposed
    int stride = in_s ? M : 1;
    if (in_u) {
        column = side == 0 ? u + (lane - M) : u + (lane - M) * M;
        stride = side == 0 ? M : 1;
    }
    const long long further = in_s || in_u ? block : row;
    float* const w = shared[side];
    float a[M], next[M];
    float pivot = 0.0f;  // inverse of the factor's diagonal, in lane j that of row j

    auto load = [&](int r, float* to) {
        const float* from = column + r * further;
        for (int k = 0; k < M; ++k) to[k] = from[k * stride];
    };
    auto ask = [&](int r) {  // for the blocks of row r, so that they are nearer when they are loaded
        constexpr int SECTORS = (M * M + 7) / 8;
        const float* from = (lane < SECTORS ? d + 8 * lane : u + 8 * (lane - SECTORS)) + r * block;
        if (lane < 2 * SECTORS) asm volatile("prefetch.global.L2 [%0];" ::"l"(from));
    };
    auto factor = [&]() {
        for (int j = 0; j < M; ++j) {
            const float inverse = rsqrtf(fmaxf(__shfl_sync(ALL, a[j], j), SMALLEST_PIVOT));
            if (lane == j) pivot = inverse;
            a[j] *= inverse;
            for (int i = j + 1; i < M; ++i) a[i] -= __shfl_sync(ALL, a[j], i) * a[j];
        }
    };
    auto store = [&](int r) {  // L^T with inverted diagonal, W and y where S, U and b were
        const int last = in_s ? lane : in_b || (in_u && r != middle) ? M - 1 : -1;
        float* to = column + r * further;
        for (int k = 0; k < M; ++k)
            if (k <= last) to[k * stride] = in_s && k == lane ? pivot : a[k];
    };
    auto product = [&](float* out) {  // W^T W and W^T y
        if (in_u)
            for (int k = 0; k < M; ++k) w[(lane - M) * PADDED + k] = a[k];
        __syncwarp();
        for (int i = 0; i < M; ++i) {
            float sum = 0.0f;
            for (int k = 0; k < M; ++k) sum += w[i * PADDED + k] * a[k];
            out[i] = __shfl_sync(ALL, sum, in_s ? lane + M : lane);
        }
        __syncwarp();
    };
    const bool finds_other = SIDES == 2 && in_u, finds = in_s || finds_other;
    const int own = in_s ? lane : finds_other ? lane - M : M - 1;  // row of the solution that this lane is to find
    const int group = finds_other ? M : 0;  // first lane of its right-hand side
    float* const back = (finds_other ? OTHER.data : rhs.data) + (long long)world * M;
    const float* const own_d = d + own * M;
    const float* const own_u = side == 0 ? u + own * M : u + own;
    const int stride_u = side == 0 ? 1 : M;
    auto load_back = [&](int r, float* lower, float* coupling, float& y) {
        for (int k = 0; k < M; ++k) lower[k] = own_d[r * block + k];
        for (int k = 0; k < M; ++k) coupling[k] = own_u[r * block + k * stride_u];
        y = back[r * row + own];
    };
    auto substitute = [&](const float* lower, float y) {  // x = L^-T y
        float x = 0.0f;
        for (int j = M - 1; j >= 0; --j) {
            const float found = __shfl_sync(ALL, y * lower[j], group + j);
            if (own == j) x = found;
            y -= lower[j] * found;
        }
        return x;
    };

    int r = side == 0 ? 0 : rows - 1, done = 0;
    float taken[M];
    for (int k = 0; k < M; ++k) taken[k] = 0.0f;
#if KEEPS
    if (side == 1 && light < rows) {  // of rows whose L and W are kept y alone is missing
        const int i = in_s ? lane : M - 1;
        float lower[M], coupling[M], lower_next[M], coupling_next[M];
        float y = 0.0f, c = b[r * row + i], c_next = 0.0f;
        for (int k = 0; k < M; ++k) {
            lower[k] = lower_next[k] = d[r * block + k * M + i];
            coupling[k] = coupling_next[k] = 0.0f;
        }
        for (; r >= light; --r) {
            if (r > light) {
                for (int k = 0; k < M; ++k) lower_next[k] = d[(r - 1) * block + k * M + i];
                for (int k = 0; k < M; ++k) coupling_next[k] = u[r * block + i * M + k];
                c_next = b[(r - 1) * row + i];
                if (r - 2 >= light) ask(r - 2);
            }
            for (int k = 0; k < M; ++k) c -= coupling[k] * __shfl_sync(ALL, y, k);
            for (int j = 0; j < M; ++j) {
                const float found = __shfl_sync(ALL, c * lower[j], j);
                if (i == j) y = found;
                c -= lower[j] * found;
            }
            if (in_s) b[r * row + i] = y;
            for (int k = 0; k < M; ++k) {
                lower[k] = lower_next[k];
                coupling[k] = coupling_next[k];
            }
            c = c_next;
        }
        __syncwarp();
        done = rows - light;
        load(light, a);
        product(taken);
        load(r, next);
        for (int k = 0; k < M; ++k) a[k] = in_u ? next[k] : next[k] - taken[k];
    } else
#endif
    if (side == 0 || count > 0) load(r, a);
    for (int n = done; n < count; ++n, r += step) {
        load(r + step, next);
        if (n + 2 < count) ask(r + 2 * step);
        factor();
        store(r);
        product(taken);
        for (int k = 0; k < M; ++k) a[k] = in_u ? next[k] : next[k] - taken[k];
    }
    if (side == 1 && (in_s || in_b))
        for (int k = 0; k < M; ++k) above[k][in_s ? lane : M + in_other] = taken[k];
    __syncthreads();
    float lower[M], coupling[M], lower_next[M], coupling_next[M];
    float y, y_next;
    if (side == 0) {
        if (in_s || in_b)
            for (int k = 0; k < M; ++k) a[k] -= above[k][in_s ? lane : M + in_other];
        factor();
        store(middle);
        __syncwarp();
        for (int k = 0; k < M; ++k) lower[k] = own_d[middle * block + k];
        const float x = substitute(lower, back[middle * row + own]);
        if (finds) solved[finds_other][own] = back[middle * row + own] = x;
    }
    __syncthreads();
    float x = solved[finds_other][own];
    if (count > 0) load_back(middle - step, lower, coupling, y);
    for (int n = 1; n <= count; ++n) {
        r = middle - n * step;
        if (n < count) load_back(r - step, lower_next, coupling_next, y_next);
        if (n + 2 <= count) ask(r - 2 * step);
        for (int k = 0; k < M; ++k) y -= coupling[k] * __shfl_sync(ALL, x, group + k);
        x = substitute(lower, y);
        if (finds) back[r * row + own] = x;
        for (int k = 0; k < M; ++k) {
            lower[k] = lower_next[k];
            coupling[k] = coupling_next[k];
        }
        y = y_next;
    }
#if KEEPS
    if (thread == 0) kept.middle.data[world] = middle;
#endif
#endif
""".replace("MODES", str(MODES)).replace("SMALLEST_PIVOT", f"{float(SMALLEST_PIVOT)}f")


def _code(sides: int, other: str, keeps: bool) -> str:
    """Return the code for one or two right-hand sides, the ``other`` one by name, and with or without rows ``kept``."""
    return _SOLVE.replace("RIGHT_HAND_SIDES", str(sides)).replace("OTHER", other).replace("KEEPS", str(int(keeps)))


@wp.func_native(_code(1, "rhs", False))
def solve_world(diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float], world: int, thread: int):
    """Solve the system of ``world``; all threads of a block have to call it."""
    ...


@wp.func_native(_code(2, "other", False))
def solve_world_twice(
    diagonal: wp.array4d[float],
    upper: wp.array4d[float],
    rhs: wp.array3d[float],
    other: wp.array3d[float],
    world: int,
    thread: int,
):
    """Solve the system of ``world`` for two right-hand sides; all threads of a block have to call it."""
    ...


@wp.func_native(_code(1, "rhs", True))
def solve_changed_world(
    diagonal: wp.array4d[float],
    upper: wp.array4d[float],
    rhs: wp.array3d[float],
    kept: KeptRows,
    world: int,
    thread: int,
):
    """Solve the system of ``world`` with the factors that are ``kept``; all threads of a block have to call it."""
    ...


@wp.kernel(launch_bounds=(THREADS, 8))
def solve_rows(diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float]):
    """Solve every world's system. Launch (W, ``THREADS``) in blocks of ``THREADS``.

    Args:
        diagonal: Blocks D, shape (R, W, M, M); overwritten.
        upper: Couplings U to the next row, shape (R, W, M, M); overwritten.
        rhs: Right-hand side b, shape (R, W, M); the solution x afterwards.
    """
    world, thread = wp.tid()
    solve_world(diagonal, upper, rhs, world, thread)


@wp.kernel(launch_bounds=(THREADS, 8), module="unique")
def solve_changed_rows(diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float], kept: KeptRows):
    """Do as ``solve_rows`` with the factors of rows that are kept. Launch (W, ``THREADS``) in blocks of ``THREADS``.

    Args:
        diagonal: Blocks D, shape (R, W, M, M), of the rows that are not kept; overwritten. Of the others the factors.
        upper: Couplings U to the next row, shape (R, W, M, M), where neither row is kept; overwritten, likewise.
        rhs: Right-hand side b, shape (R, W, M); the solution x afterwards.
        kept: Rows that are kept; ``middle`` is written.
    """
    world, thread = wp.tid()
    solve_changed_world(diagonal, upper, rhs, kept, world, thread)


@wp.kernel(launch_bounds=(THREADS, 8), module="unique")
def solve_rows_twice(
    diagonal: wp.array4d[float], upper: wp.array4d[float], rhs: wp.array3d[float], other: wp.array3d[float]
):
    """Solve every world's system for two right-hand sides. Launch (W, ``THREADS``) in blocks of ``THREADS``.

    Args:
        diagonal: Blocks D, shape (R, W, M, M); overwritten.
        upper: Couplings U to the next row, shape (R, W, M, M); overwritten.
        rhs: Right-hand side b, shape (R, W, M); the solution x afterwards.
        other: The other right-hand side, likewise.
    """
    world, thread = wp.tid()
    solve_world_twice(diagonal, upper, rhs, other, world, thread)
