# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Solver for block-tridiagonal, symmetric positive definite systems, one a world."""

from __future__ import annotations

import warp as wp

from arcgym.sim.wall import block_tridiagonal_kernels as kernels
from arcgym.sim.wall.ring_modes import MODES


class BlockTridiagonalSolver:
    """Cyclic reduction: log2(rows) levels, each parallel over worlds and rows, always summed in the same order.

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
        self.num_envs, self.rows, self.device = num_envs, rows, device
        blocks = [wp.zeros((rows, MODES, MODES, num_envs), dtype=float, device=device) for _ in range(4)]
        self.diagonal, self.upper, self._left, self._right = blocks
        """``diagonal`` and ``upper`` (coupling to the next row): float, shape (R, M, M, W)."""
        self.rhs = wp.zeros((rows, MODES, num_envs), dtype=float, device=device)
        """Right-hand side, then the solution: float, shape (R, M, W)."""

    def solve(self) -> None:
        """Solve all systems in place."""
        distances = [1 << level for level in range((self.rows - 1).bit_length())]
        for h in distances:
            self._reduce(h)
        self._launch(kernels.factor_odd, (1,), [0, 1], [self.diagonal])
        self._launch(kernels.solve_root, (), [self.diagonal], [self.rhs])
        for h in reversed(distances):
            inputs = [h, self.diagonal, self._left, self._right]
            self._launch(kernels.back_substitute, (self._odd(h),), inputs, [self.rhs])

    def _reduce(self, h: int) -> None:
        odd = self._odd(h)
        even = (self.rows - 1) // (2 * h) + 1
        self._launch(kernels.factor_odd, (odd,), [h, 2 * h], [self.diagonal])
        sides = [self._left, self._right]
        self._launch(kernels.eliminate_odd, (odd, 2 * MODES + 1), [h, self.diagonal, self.upper], [*sides, self.rhs])
        self._launch(kernels.reduce_even, (even, MODES), [h, *sides], [self.diagonal, self.upper, self.rhs])

    def _odd(self, h: int) -> int:
        """Return the number of rows h, 3h, 5h, ... that exist."""
        return (self.rows - 1 + h) // (2 * h)

    def _launch(self, kernel: wp.Kernel, rows: tuple[int, ...], inputs: list, outputs: list) -> None:
        wp.launch(kernel, (*rows, self.num_envs), inputs=inputs, outputs=outputs, device=self.device)
