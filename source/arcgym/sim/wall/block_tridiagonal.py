# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Solver for block-tridiagonal, symmetric positive definite systems, one a world."""

from __future__ import annotations

import warp as wp

from arcgym.sim.wall import block_tridiagonal_cuda_kernels as cuda_kernels
from arcgym.sim.wall import block_tridiagonal_kernels as kernels
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.ring_modes import MODES


class BlockTridiagonalSolver:
    """Block Cholesky, row after row: one thread a world on a CPU, two warps a world on a GPU.

    Fill :attr:`diagonal`, :attr:`upper` and :attr:`rhs`, call :meth:`solve`, read the solution from :attr:`rhs`.
    All of them are overwritten.
    """

    def __init__(self, num_envs: int, rows: int, device: str):
        """Allocate the systems.

        Args:
            num_envs: Worlds, W.
            rows: Block rows of each system, R.
            device: Warp device.
        """
        self.num_envs, self.device = num_envs, device
        blocks = [wp.zeros((rows, num_envs, MODES, MODES), dtype=float, device=device) for _ in range(2)]
        self.diagonal, self.upper = blocks
        """``diagonal`` and ``upper`` (coupling to the next row): float, shape (R, W, M, M)."""
        self.rhs = wp.zeros((rows, num_envs, MODES), dtype=float, device=device)
        """Right-hand side, then the solution: float, shape (R, W, M)."""

    def solve(self, also: wp.array | None = None) -> None:
        """Solve all systems in place.

        Args:
            also: Further right-hand side, then its solution: float, shape (R, W, M); None for none.
        """
        blocks, sides = [self.diagonal, self.upper], [self.rhs] if also is None else [self.rhs, also]
        if wp.get_device(self.device).is_cuda:
            kernel = cuda_kernels.solve_rows if also is None else cuda_kernels.solve_rows_twice
            shape, threads = (self.num_envs, cuda_kernels.THREADS), cuda_kernels.THREADS
            wp.launch(kernel, shape, outputs=[*blocks, *sides], device=self.device, block_dim=threads)
            return
        self.eliminate(0, self.diagonal.shape[0])
        self.substitute()
        if also is not None:
            wp.launch(kernels.solve_again, self.num_envs, inputs=blocks, outputs=[also], device=self.device)

    def solve_changed(self, kept: KeptRows) -> None:
        """Solve all systems in place on a GPU, which were filled but for the rows that are ``kept``.

        Those have to be as :meth:`solve_changed` has left them, but for their right-hand sides.
        """
        shape, threads = (self.num_envs, cuda_kernels.THREADS), cuda_kernels.THREADS
        outputs = [self.diagonal, self.upper, self.rhs, kept]
        wp.launch(cuda_kernels.solve_changed_rows, shape, outputs=outputs, device=self.device, block_dim=threads)

    def eliminate(self, first: int, count: int) -> None:
        """Begin to solve, on a CPU: go down ``count`` rows from ``first`` on, those before it having been done."""
        outputs = [self.diagonal, self.upper, self.rhs]
        wp.launch(kernels.eliminate_rows, self.num_envs, inputs=[first, count], outputs=outputs, device=self.device)

    def substitute(self) -> None:
        """Finish solving, on a CPU, when all rows have been gone down."""
        outputs = [self.diagonal, self.upper, self.rhs]
        wp.launch(kernels.substitute_rows, self.num_envs, outputs=outputs, device=self.device)
