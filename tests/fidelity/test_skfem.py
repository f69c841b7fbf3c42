# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The bricks behind the wall's references against an established finite-element package."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.benchmarks.fidelity.tube_model import TubeModel

skfem = pytest.importorskip("skfem")


def test_bricks_have_the_stiffness_of_scikit_fem() -> None:
    """One 27-node brick, a straight box, bent, sheared and stretched at random: the same elastic energy."""
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    model = box_model()
    points = model.points()
    mesh = skfem.MeshHex().scaled((0.002, 0.003, 0.004))
    element = skfem.ElementVector(skfem.ElementHex2())
    basis = skfem.Basis(mesh, element, intorder=5)
    stiffness = linear_elasticity(*lame_parameters(5.0e6, 0.45)).assemble(basis)

    def displacement(x: np.ndarray) -> np.ndarray:
        a, b, c = x / 0.004
        return 1.0e-5 * np.array([a * b + c**2, b**2 - a * c, a * b * c + 0.3 * a])

    theirs = basis.project(displacement)
    ours = displacement(points.T).T.ravel()
    assert ours @ (model.stiffness() @ ours) == pytest.approx(theirs @ (stiffness @ theirs), rel=1e-6)


def box_model() -> TubeModel:
    class Box(TubeModel):
        def points(self) -> np.ndarray:
            z, y, x = np.meshgrid(*(np.linspace(0.0, s, 3) for s in (0.004, 0.003, 0.002)), indexing="ij")
            return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

        def bricks(self) -> np.ndarray:
            return np.arange(27)[None]

    return Box(0.004, 1.0, 0.002, 5.0e6, 0.45)
