# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What the threads of a GPU's block find together; on a CPU each thread is one of its own.

All threads of a block, a multiple of 32, have to call each of these together.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

LANES = 256
"""Threads of a block on a GPU."""


def lanes(device: wp.Device) -> int:
    """Return how many threads work together on a device."""
    return LANES if device.is_cuda else 1


_TOGETHER = """
#if defined(__CUDA_ARCH__)
    __shared__ TYPE parts[32];
    for (int away = 16; away > 0; away /= 2) {
        const TYPE other = __shfl_xor_sync(0xffffffffu, value, away);
        value = JOIN;
    }
    __syncthreads();  // until all have read what the call before left
    if (threadIdx.x % 32 == 0) parts[threadIdx.x / 32] = value;
    __syncthreads();
    value = parts[0];
    for (int k = 1; k < blockDim.x / 32; ++k) {
        const TYPE other = parts[k];
        value = JOIN;
    }
#endif
    return value;
"""


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    __syncthreads();
#endif
""")
def wait_for_block():
    """Wait until all threads of the block are here, and see what they wrote."""
    ...


@wp.func_native(_TOGETHER.replace("TYPE", "float").replace("JOIN", "fminf(value, other)"))
def block_least(value: float) -> float:
    """Return the least of the threads' values."""
    ...


@wp.func_native(_TOGETHER.replace("TYPE", "float").replace("JOIN", "fmaxf(value, other)"))
def block_most(value: float) -> float:
    """Return the largest of the threads' values."""
    ...


@wp.func_native(_TOGETHER.replace("TYPE", "long long").replace("JOIN", "value + other"))
def block_sum(value: wp.int64) -> wp.int64:
    """Return the sum of the threads' values."""
    ...
