# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Work that the threads of a GPU block list for one another, in shared memory.

Where each thread finds few of the cases that take long, all threads of a warp wait for the one that has found one. A
kernel that lists them first and then shares them out keeps all busy. It has to be launched so that the threads of one
list are one block. On a CPU, where threads run one after the other, nothing is listed and nobody waits: a thread deals
with what could not be listed at once.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

CAPACITY = 2048
"""Entries of a block's queue: 8 KiB of the shared memory."""

_QUEUE = """
#if defined(__CUDA_ARCH__)
    __shared__ int entries[CAPACITY];
    __shared__ int length;
    if (action == 0) length = 0;
    if (action == 1) {
        const int at = atomicAdd(&length, 1);
        if (at < CAPACITY) entries[at] = value;
        return at < CAPACITY;
    }
    if (action == 2) return min(length, CAPACITY);
    if (action == 3) return entries[value];
#endif
    return 0;
""".replace("CAPACITY", str(CAPACITY))


@wp.func_native(_QUEUE)
def queue(action: int, value: int) -> int:
    """Empty the queue (0), list ``value`` (1), return the number of entries (2) or entry ``value`` (3)."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    __syncthreads();
#endif
""")
def wait_for_block():
    """Wait until all threads of the block are here; what they have written before can then be read."""
    ...


@wp.func
def clear_queue(thread: int):
    """Empty the queue; all threads of the block have to call it."""
    if thread == 0:
        queue(0, 0)
    wait_for_block()


@wp.func
def queued(value: int) -> bool:
    """List ``value``; return whether there was room."""
    return queue(1, value) == 1


@wp.func
def queue_length() -> int:
    """Return how many values are listed; valid after :func:`wait_for_block`."""
    return queue(2, 0)


@wp.func
def queue_entry(index: int) -> int:
    """Return a listed value, in any order."""
    return queue(3, index)
