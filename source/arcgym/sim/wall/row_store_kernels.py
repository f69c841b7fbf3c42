# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Rows of the ring equations to memory: on a GPU the threads of a warp, a row each, write theirs together.

A thread that writes its M numbers one after the other touches another sector of the memory than its neighbor with each
of them. Exchanged in shared memory first, 32 neighboring numbers at a time go out in one piece.
"""

import warp as wp

from arcgym.sim.wall.block_tridiagonal_kernels import Unknowns
from arcgym.sim.wall.ring_modes import MODES
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_setup import GPU_BLOCK

_STORE = """
    constexpr int M = MODES;
    const long long own = ((long long)r * blocks.shape[1] + w) * M + a;
#if defined(__CUDA_ARCH__)
    __shared__ float rows[GPU_BLOCK / 32][32 * M];
    const int lane = threadIdx.x % 32;
    const long long first = own - lane;  // row of the warp's first thread
    if (first + 32 <= (long long)blocks.shape[0] * blocks.shape[1] * M) {
        float* const shared = rows[threadIdx.x / 32];
        __syncwarp();
        for (int k = 0; k < M; ++k) shared[lane * M + k] = row[k];
        __syncwarp();
#if SOME
        const unsigned wanted = __ballot_sync(0xffffffffu, want);
        for (int k = 0; k < M; ++k)
            if (wanted >> ((32 * k + lane) / M) & 1u) blocks.data[first * M + 32 * k + lane] = shared[32 * k + lane];
#else
        for (int k = 0; k < M; ++k) blocks.data[first * M + 32 * k + lane] = shared[32 * k + lane];
#endif
        return;
    }
#endif
#if SOME
    if (!want) return;
#endif
    for (int k = 0; k < M; ++k) blocks.data[own * M + k] = row[k];
""".replace("MODES", str(MODES)).replace("GPU_BLOCK", str(GPU_BLOCK))


@wp.func_native(_STORE.replace("SOME", "0"))
def store_row(blocks: wp.array4d[float], r: int, w: int, a: int, row: Unknowns):
    """Write ``row`` to ``blocks[r, w, a]``, shape (R, W, M, M).

    All threads of a kernel launched as (R, W, M) in blocks of ``GPU_BLOCK`` have to call it, each for its own row.
    """
    ...


@wp.func_native(_STORE.replace("SOME", "1"))
def store_row_if(blocks: wp.array4d[float], r: int, w: int, a: int, row: Unknowns, want: bool):
    """Do as :func:`store_row`, for the threads that want it."""
    ...
