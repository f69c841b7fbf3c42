# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Articulated-body algorithm on a GPU: what :mod:`.aba_kernels` does, by a warp a world.

Inwards, each of six lanes holds a column of the articulated body's 6x6 matrix, which is symmetric, and all of them its
bias force. A joint takes one exchange of the column that it meets with, and one fused product in all lanes at once.
Outwards, all lanes find the accelerations together; the joints are then moved side by side, and poses, spins and
velocities of the links are sums along the chain, which a warp forms in a few exchanges. What is read more than once is
in shared memory.
"""

import functools

import warp as wp

from arcgym.sim.scope.aba_cuda_code import SOLVE
from arcgym.sim.scope.scope_kernels import Chain, ChainWork
from arcgym.utils import warp_setup  # noqa: F401

THREADS = 32
"""Threads a world, which are one block: a warp."""
JOINT_FLOATS = 14
"""Floats of a joint in shared memory: a row of ``joints`` in the code."""
LINK_FLOATS = 15
"""Floats of a link in shared memory: a row of ``links`` in the code."""
SHARED_BYTES = 48 * 1024
"""Shared memory that a block may have without asking."""


def fits(links: int, dofs: int) -> bool:
    """Return whether a world's chain fits the shared memory of a block."""
    return 4 * (dofs * JOINT_FLOATS + links * (LINK_FLOATS + 1) + 1) <= SHARED_BYTES


@functools.cache
def warp_kernel(links: int, dofs: int) -> wp.Kernel:
    """Make the kernel for chains of ``links`` links and ``dofs`` degrees of freedom, L and D."""
    code = SOLVE.replace("LINKS", str(links)).replace("DOFS", str(dofs))

    @wp.func_native(code)
    def solve_world(
        chain: Chain,
        body_q: wp.array[wp.transform],
        body_qd: wp.array[wp.spatial_vector],
        dt: float,
        work: ChainWork,
        joint_q: wp.array[float],
        joint_qd: wp.array[float],
        body_q_out: wp.array[wp.transform],
        body_qd_out: wp.array[wp.spatial_vector],
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
        dt: float,
        work: ChainWork,
        joint_q: wp.array[float],
        joint_qd: wp.array[float],
        body_q_out: wp.array[wp.transform],
        body_qd_out: wp.array[wp.spatial_vector],
    ):
        """Do as :func:`arcgym.sim.scope.aba_kernels.solve_chain`. Launch (W, ``THREADS``) in blocks of ``THREADS``."""
        world, lane = wp.tid()
        solve_world(chain, body_q, body_qd, dt, work, joint_q, joint_qd, body_q_out, body_qd_out, world, lane)

    return solve_chain_by_warp
