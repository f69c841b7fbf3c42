# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random block-tridiagonal systems against numpy's dense solver."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.sim.chain_solver import ChainSolver

SIZE = 9


def random_system(rng: np.random.Generator, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Symmetric positive definite matrix of coupled neighbours, shape (9R, 9R), and a right-hand side."""
    matrix = np.zeros((rows, SIZE, rows, SIZE))
    for r in range(rows):
        block = rng.normal(size=(SIZE, SIZE))
        matrix[r, :, r] = block @ block.T + 20.0 * np.eye(SIZE)
        if r + 1 < rows:
            matrix[r, :, r + 1] = rng.normal(size=(SIZE, SIZE))
            matrix[r + 1, :, r] = matrix[r, :, r + 1].T
    return matrix.reshape(rows * SIZE, rows * SIZE), rng.normal(size=rows * SIZE)


@pytest.mark.parametrize("rows", [1, 2, 3, 8, 17])
def test_solution_agrees_with_a_dense_solver(rows: int) -> None:
    rng = np.random.default_rng(rows)
    systems = [random_system(rng, rows) for _ in range(2)]
    blocks = np.stack([matrix.reshape(rows, SIZE, rows, SIZE) for matrix, _ in systems])
    upper = np.zeros((2, rows, SIZE, SIZE))
    for r in range(rows - 1):
        upper[:, r] = blocks[:, r, :, r + 1]
    chain = ChainSolver(2, rows, "cpu")
    chain.diagonal.assign(np.stack([blocks[:, r, :, r] for r in range(rows)], axis=1))
    chain.upper.assign(upper)
    chain.rhs.assign(np.stack([rhs.reshape(rows, SIZE) for _, rhs in systems]))
    chain.solve()
    expected = np.stack([np.linalg.solve(matrix, rhs).reshape(rows, SIZE) for matrix, rhs in systems])
    np.testing.assert_allclose(chain.rhs.numpy(), expected, atol=2e-5 * np.abs(expected).max())
