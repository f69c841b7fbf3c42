# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Articulated-body algorithm on a GPU: what :mod:`.aba_kernels` does, by a warp a world.

The lanes prepare joints and links side by side, the links 32 at a time from the tip, and leave them in shared memory.
Inwards, each of six lanes holds a column of the articulated body's 6x6 matrix, which is symmetric, and all of them its
bias force. A joint takes one exchange of the column that it meets with, and one fused product in all lanes at once.
Outwards, all lanes find the accelerations together; the joints are then moved side by side, and poses, spins and
velocities of the links are sums along the chain, which a warp forms in a few exchanges. What is read more than once is
in shared memory.
"""

import functools

import warp as wp

from arcgym.sim.scope.aba_cuda_code import SOLVE
from arcgym.sim.scope.load_row_kernels import LoadRows
from arcgym.sim.scope.scope_kernels import Chain, ChainWork
from arcgym.utils import warp_setup  # noqa: F401

THREADS = 32
"""Threads a world, which are one block: a warp."""
JOINT_FLOATS = 12
"""Floats of a joint in shared memory: a row of ``joints`` in the code."""
LINK_FLOATS = 9
"""Floats of a link in shared memory: a row of ``links`` in the code."""
CHUNK_FLOATS = 32 * 33
"""Floats of the links that are prepared together: ``room`` in the code, where accelerations follow, six a link."""
SHARED_BYTES = 48 * 1024
"""Shared memory that a block may have without asking."""


def fits(links: int, dofs: int) -> bool:
    """Return whether a world's chain fits the shared memory of a block."""
    room = max(CHUNK_FLOATS, 6 * links)
    return 4 * (dofs * JOINT_FLOATS + links * LINK_FLOATS + room) + 2 * (links + 1) <= SHARED_BYTES


@functools.cache
def warp_kernel(links: int, dofs: int) -> wp.Kernel:
    """Make the kernel for chains of ``links`` links and ``dofs`` degrees of freedom, L and D."""
    code = SOLVE.replace("LINKS", str(links)).replace("DOFS", str(dofs))

    @wp.func_native(code)
    def solve_world(
        chain: Chain,
        body_q: wp.array[wp.transform],
        body_qd: wp.array[wp.spatial_vector],
        body_f: wp.array[wp.spatial_vector],
        target: wp.array[float],
        joint_f: wp.array[float],
        resistance: wp.array2d[wp.spatial_vector],
        loads: LoadRows,
        dt: float,
        weight: float,
        work: ChainWork,
        joint_q: wp.array[float],
        joint_qd: wp.array[float],
        body_q_out: wp.array[wp.transform],
        body_qd_out: wp.array[wp.spatial_vector],
        mean_load: wp.array[wp.vec3],
        world: int,
        lane: int,
    ):
        """Solve the chain of ``world``; all threads of a block have to call it."""
        ...

    @wp.kernel(module="unique")
    def solve_chain_by_warp(
        chain: Chain,
        body_q: wp.array[wp.transform],
        body_qd: wp.array[wp.spatial_vector],
        body_f: wp.array[wp.spatial_vector],
        target: wp.array[float],
        joint_f: wp.array[float],
        resistance: wp.array2d[wp.spatial_vector],
        loads: LoadRows,
        dt: float,
        weight: float,
        work: ChainWork,
        joint_q: wp.array[float],
        joint_qd: wp.array[float],
        body_q_out: wp.array[wp.transform],
        body_qd_out: wp.array[wp.spatial_vector],
        mean_load: wp.array[wp.vec3],
    ):
        """Prepare, solve and record. Launch (W, ``THREADS``) in blocks of ``THREADS``.

        Does as :func:`~.scope_kernels.prepare_joints`, :func:`~.scope_kernels.prepare_links`,
        :func:`~.aba_kernels.solve_chain` and :func:`~.scope_kernels.record_loads` do one after the other, whose
        arguments these are; just ``loads`` are rows here, and a ``mean_load`` of None is not recorded. Of ``work``
        drives, ``drive_force``, ``lever`` and the accelerations are written, the rest is left alone.
        """
        world, lane = wp.tid()
        solve_world(
            chain,
            body_q,
            body_qd,
            body_f,
            target,
            joint_f,
            resistance,
            loads,
            dt,
            weight,
            work,
            joint_q,
            joint_qd,
            body_q_out,
            body_qd_out,
            mean_load,
            world,
            lane,
        )

    return solve_chain_by_warp
