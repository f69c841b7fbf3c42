# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Solver for block-tridiagonal, symmetric positive definite systems, one a world."""

from __future__ import annotations

import warp as wp

from arcgym.sim import chain_kernels as kernels


class ChainSolver:
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
        shape = (num_envs, rows)
        blocks = [wp.zeros(shape, dtype=kernels.Block, device=device) for _ in range(4)]
        self._diagonal, self._upper, self._left, self._right = blocks
        self._rhs = wp.zeros(shape, dtype=kernels.Unknowns, device=device)
        self.diagonal, self.upper, self._left_scalars, self._right_scalars = (_scalars(block) for block in blocks)
        """``diagonal`` and ``upper`` (coupling to the next row): float, shape (W, R, 9, 9)."""
        self.rhs = _scalars(self._rhs)
        """Right-hand side, then the solution: float, shape (W, R, 9)."""

    def solve(self) -> None:
        """Solve all systems in place."""
        distances = [1 << level for level in range((self.rows - 1).bit_length())]
        for h in distances:
            self._reduce(h)
        self._launch(kernels.factor_odd, (self.num_envs, 1), [0, 1, self._diagonal])
        self._launch(kernels.solve_root, (self.num_envs,), [self._diagonal, self._rhs])
        for h in reversed(distances):
            args = [h, self._diagonal, self._left, self._right, self._rhs]
            self._launch(kernels.back_substitute, (self.num_envs, self._odd(h)), args)

    def _reduce(self, h: int) -> None:
        odd = self._odd(h)
        even = (self.rows - 1) // (2 * h) + 1
        self._launch(kernels.factor_odd, (self.num_envs, odd), [h, 2 * h, self._diagonal])
        sides = [self._left_scalars, self._right_scalars]
        self._launch(kernels.eliminate_odd, (self.num_envs, odd, 19), [h, self._diagonal, self.upper, *sides, self.rhs])
        self._launch(kernels.reduce_even, (self.num_envs, even, 9), [h, *sides, self.diagonal, self.upper, self.rhs])

    def _odd(self, h: int) -> int:
        """Number of rows h, 3h, 5h, ... that exist."""
        return (self.rows - 1 + h) // (2 * h)

    def _launch(self, kernel: wp.Kernel, dim: tuple[int, ...], args: list) -> None:
        wp.launch(kernel, dim, args, device=self.device)


def _scalars(array: wp.array) -> wp.array:
    """The same memory as single numbers, matrix or vector dimensions last."""
    shape = (*array.shape, *array.dtype._shape_)
    return wp.array(ptr=array.ptr, dtype=float, shape=shape, device=array.device, copy=False)
