# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random block-tridiagonal systems against numpy's dense solver."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from arcgym.sim.wall.block_tridiagonal import BlockTridiagonalSolver
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.ring_modes import MODES


def random_system(rng: np.random.Generator, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Symmetric positive definite matrix of coupled neighbors, shape (M R, M R), and a right-hand side."""
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


@pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA")
@pytest.mark.parametrize("rows", [2, 3, 24])
def test_rows_whose_factors_are_kept(rows: int) -> None:
    """Of two worlds the first rows change, as many as said, and all right-hand sides."""
    rng, device = np.random.default_rng(rows), "cuda:0"
    system, kept = BlockTridiagonalSolver(2, rows, device), KeptRows()
    kept.first = wp.zeros(2, dtype=int, device=device)
    kept.middle = wp.full(2, -1, dtype=int, device=device)
    matrices = [random_system(rng, rows)[0] for _ in range(2)]
    for first in ([rows, rows], [1, rows // 2], [rows // 3, 0], [0, 0], [rows - 1, 1], [rows, 0], [2 * rows // 3, 1]):
        middle = kept.middle.numpy()
        diagonal, upper, rhs = (one.numpy() for one in (system.diagonal, system.upper, system.rhs))
        for w in range(2):
            other = random_system(rng, rows)[0]
            changed = first[w] * MODES
            matrices[w][:changed, :changed] = other[:changed, :changed]
            blocks = matrices[w].reshape(rows, MODES, rows, MODES)
            light = rows if middle[w] < 0 else max(first[w], middle[w] + 1)
            for r in range(light):
                diagonal[r, w] = blocks[r, :, r]
                if r + 1 < light or light == rows:
                    upper[r, w] = blocks[r, :, r + 1] if r + 1 < rows else 0.0
            rhs[:, w] = rng.normal(size=(rows, MODES))
        expected = [np.linalg.solve(matrices[w], rhs[:, w].ravel()).reshape(rows, MODES) for w in range(2)]
        system.diagonal.assign(diagonal)
        system.upper.assign(upper)
        system.rhs.assign(rhs)
        kept.first.assign(np.array(first, np.int32))
        system.solve_changed(kept)
        np.testing.assert_allclose(system.rhs.numpy(), np.stack(expected, axis=1), atol=2e-5 * np.abs(expected).max())
        assert ((kept.middle.numpy() >= 0) & (kept.middle.numpy() < rows)).all()
