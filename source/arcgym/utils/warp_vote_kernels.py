# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""What the 32 threads of a GPU's warp find together; on a CPU each thread is one of its own.

All threads of a warp have to call each of these together.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

LANES = 32
"""Threads of a warp on a GPU."""
GROUP = 8
"""Neighboring threads that add up together, a divisor of ``LANES``."""


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return (int)__ballot_sync(0xffffffffu, yes);
#endif
    return yes ? 1 : 0;
""")
def votes(yes: bool) -> int:
    """Return which threads of the warp say yes, a bit each."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return __popc(bits & ((1u << lane) - 1u));
#endif
    return 0;
""")
def votes_before(bits: int, lane: int) -> int:
    """Return how many threads before ``lane`` said yes."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return __popc(bits);
#endif
    return bits;
""")
def vote_count(bits: int) -> int:
    """Return how many threads said yes."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return __ffs(bits) - 1;
#endif
    return bits - 1;
""")
def first_vote(bits: int) -> int:
    """Return the first thread that said yes; one at least has to."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return 31 - __clz(bits);
#endif
    return bits - 1;
""")
def last_vote(bits: int) -> int:
    """Return the last thread that said yes; one at least has to."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return __reduce_add_sync(0xffffffffu, value);
#endif
    return value;
""")
def warp_sum(value: int) -> int:
    """Return the sum of the warp's values."""
    ...


@wp.func_native(
    """
#if defined(__CUDA_ARCH__)
    const unsigned group = ((1u << GROUP) - 1u) << (threadIdx.x % 32 / GROUP * GROUP);
    for (int k = 0; k < 3; ++k) {
        float& one = value[k];
        for (int step = GROUP / 2; step > 0; step /= 2) one += __shfl_xor_sync(group, one, step);
    }
#endif
    return value;
""".replace("GROUP", str(GROUP))
)
def sum_of_group(value: wp.vec3) -> wp.vec3:
    """Return the sum over the ``GROUP`` neighboring threads, the same bits in each; all of them have to call it.

    Other groups of the warp may be elsewhere.
    """
    ...
