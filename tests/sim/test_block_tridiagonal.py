# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random block-tridiagonal systems against numpy's dense solver."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from arcgym.sim.wall.block_tridiagonal import BlockTridiagonalSolver
from arcgym.sim.wall.ring_modes import MODES


def random_system(rng: np.random.Generator, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Symmetric positive definite matrix of coupled neighbours, shape (M R, M R), and a right-hand side."""
    matrix = np.zeros((rows, MODES, rows, MODES))
    for r in range(rows):
        block = rng.normal(size=(MODES, MODES))
        matrix[r, :, r] = block @ block.T + 20.0 * np.eye(MODES)
        if r + 1 < rows:
            matrix[r, :, r + 1] = rng.normal(size=(MODES, MODES))
            matrix[r + 1, :, r] = matrix[r, :, r + 1].T
    return matrix.reshape(rows * MODES, rows * MODES), rng.normal(size=rows * MODES)


DEVICES = ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA"))]


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("rows", [1, 2, 3, 8, 17])
def test_solution_agrees_with_a_dense_solver(rows: int, device: str) -> None:
    rng = np.random.default_rng(rows)
    systems = [random_system(rng, rows) for _ in range(2)]
    blocks = np.stack([matrix.reshape(rows, MODES, rows, MODES) for matrix, _ in systems], axis=1)
    upper = np.zeros((rows, 2, MODES, MODES))
    for r in range(rows - 1):
        upper[r] = blocks[r, :, :, r + 1]
    system = BlockTridiagonalSolver(2, rows, device)
    system.diagonal.assign(np.stack([blocks[r, :, :, r] for r in range(rows)]))
    system.upper.assign(upper)
    system.rhs.assign(np.stack([rhs.reshape(rows, MODES) for _, rhs in systems], axis=1))
    other = rng.normal(size=(rows, 2, MODES)).astype(np.float32)
    also = wp.array(other, dtype=float, device=device)
    system.solve(also)
    expected = np.stack([np.linalg.solve(matrix, rhs).reshape(rows, MODES) for matrix, rhs in systems], axis=1)
    np.testing.assert_allclose(system.rhs.numpy(), expected, atol=2e-5 * np.abs(expected).max())
    answers = np.stack(
        [np.linalg.solve(matrix, other[:, k].ravel()).reshape(rows, MODES) for k, (matrix, _) in enumerate(systems)], 1
    )
    np.testing.assert_allclose(also.numpy(), answers, atol=2e-5 * np.abs(answers).max())
