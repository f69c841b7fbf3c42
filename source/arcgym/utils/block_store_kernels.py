# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Points that all threads of a GPU block read again and again, kept in shared memory.

Vertices of neighboring worlds lie beside each other in memory, so that a block that works on one world gets a third of
what it fetches, and waits for each of them. Copied once, they are at hand. On a CPU, and where there are more points
than there is room for, all is read from the array itself.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.block_queue_kernels import wait_for_block

ROOM = 2304
"""Points that a block has room for: 27 KiB of the shared memory."""

_POINT = """
#if defined(__CUDA_ARCH__)
    __shared__ float points[3 * ROOM];
    if (x.shape[0] <= ROOM) {
        if (write) {
            const wp::vec3 value = *wp::address(x, i, w);
            for (int k = 0; k < 3; ++k) points[3 * i + k] = value[k];
            return value;
        }
        return wp::vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    }
#endif
    return *wp::address(x, i, w);
""".replace("ROOM", str(ROOM))


@wp.func_native(_POINT)
def point(x: wp.array2d[wp.vec3], i: int, w: int, write: bool) -> wp.vec3:
    """Store ``x[i, w]``, or return it as it was stored."""
    ...


@wp.func
def store_points(x: wp.array2d[wp.vec3], w: int, thread: int, threads: int):
    """Store world ``w`` of ``x``, shape (V, W); all ``threads`` of the block have to call it."""
    if threads > 1 and x.shape[0] <= wp.static(ROOM):
        i = int(thread)
        while i < x.shape[0]:
            point(x, i, w, True)
            i += threads
        wait_for_block()


@wp.func
def stored_point(x: wp.array2d[wp.vec3], i: int, w: int) -> wp.vec3:
    """Return ``x[i, w]``, of the world that was stored."""
    return point(x, i, w, False)
