# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tube of quadratic bricks in numpy and scipy: the converged reference of the wall."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

Traction = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Load on the inside of a tube, up to a factor: (angle [rad], z [m]) -> vectors, shape (n, 3)."""


@dataclass(frozen=True)
class TubeModel:
    """Straight tube held at both ends, small strains, of 27-node bricks (Hughes, The Finite Element Method, ch. 3)."""

    length: float
    """[m]."""
    radius: float
    """Inner radius [m]."""
    thickness: float
    """[m]."""
    youngs_modulus: float
    """[Pa]."""
    poissons_ratio: float
    """Poisson's ratio."""
    around: int = 16
    """Elements around."""
    along: int = 24
    """Elements along."""

    def nodes(self) -> np.ndarray:
        """Return the nodes' cylinder coordinates (r, angle, z), shape (Z, A, 3, 3): along, around, across the wall."""
        z = np.linspace(0.0, self.length, 2 * self.along + 1)
        angle = np.linspace(0.0, 2.0 * np.pi, 2 * self.around, endpoint=False)
        r = self.radius + self.thickness * np.array([0.0, 0.5, 1.0])
        z, angle, r = np.meshgrid(z, angle, r, indexing="ij")
        return np.stack([r, angle, z], axis=-1)

    def points(self) -> np.ndarray:
        """Return the positions of the nodes [m], shape (n, 3)."""
        r, angle, z = self.nodes().reshape(-1, 3).T
        return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)

    def bricks(self) -> np.ndarray:
        """Return the nodes of the elements, shape (E, 27)."""
        columns = 2 * self.around
        i, j = np.meshgrid(2 * np.arange(self.along), 2 * np.arange(self.around), indexing="ij")
        a, b, c = np.meshgrid(range(3), range(3), range(3), indexing="ij")
        z = i.reshape(-1, 1) + a.reshape(1, -1)
        angle = (j.reshape(-1, 1) + b.reshape(1, -1)) % columns
        return (z * columns + angle) * 3 + c.reshape(1, -1)

    def stiffness(self) -> sparse.csc_matrix:
        """Return the stiffness matrix [N/m], shape (3n, 3n)."""
        points, bricks = self.points(), self.bricks()
        ratio = self.poissons_ratio
        mu = self.youngs_modulus / (2.0 * (1.0 + ratio))
        lam = self.youngs_modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio))
        blocks = np.zeros((len(bricks), 27, 3, 27, 3))
        for weight, slopes in brick_rule():
            jacobian = np.einsum("eai,aj->eij", points[bricks], slopes)
            gradient = np.einsum("aj,eji->eai", slopes, np.linalg.inv(jacobian))
            volume = weight * np.abs(np.linalg.det(jacobian))
            dots = np.einsum("e,eai,ebi->eab", mu * volume, gradient, gradient)
            blocks += np.einsum("eab,ij->eaibj", dots, np.eye(3))
            blocks += np.einsum("e,eaj,ebi->eaibj", mu * volume, gradient, gradient)
            blocks += np.einsum("e,eai,ebj->eaibj", lam * volume, gradient, gradient)
        unknowns = (3 * bricks[:, :, None] + np.arange(3)).reshape(len(bricks), 81)
        rows, columns = np.repeat(unknowns, 81, axis=1).ravel(), np.tile(unknowns, (1, 81)).ravel()
        return sparse.csc_matrix((blocks.ravel(), (rows, columns)), shape=(3 * len(points),) * 2)

    def loads(self, traction: Traction) -> np.ndarray:
        """Return the nodal forces of a load on the inside, shape (n, 3); the sizes of the vectors add up to one."""
        _, angle, z = self.nodes().reshape(-1, 3).T
        shape = self.nodes().shape[:3]
        weight = np.zeros(shape)
        weight[:, :, 0] = np.where(np.arange(shape[0]) % 2, 2.0, 1.0)[:, None]
        weight[:, :, 0] *= np.where(np.arange(shape[1]) % 2, 2.0, 1.0)
        force = weight.reshape(-1, 1) * traction(angle, z)
        return force / np.linalg.norm(force, axis=1).sum()

    def displacements(self, traction: Traction) -> np.ndarray:
        """Return the displacement of the nodes under a load of one newton [m/N], shape (n, 3)."""
        force, matrix = self.loads(traction), self.stiffness()
        z = self.points()[:, 2]
        free = np.repeat((z > 1.0e-9) & (z < self.length - 1.0e-9), 3)
        moved = np.zeros(free.shape)
        moved[free] = splu(matrix[free][:, free]).solve(force.ravel()[free])
        return moved.reshape(-1, 3)

    def compliance(self, traction: Traction, moved: np.ndarray | None = None) -> float:
        """Return the displacement under the load, weighted by it, for a load of one newton [m/N].

        Args:
            traction: The load.
            moved: :meth:`displacements` under it, if they are known.
        """
        moved = self.displacements(traction) if moved is None else moved
        return float((self.loads(traction) * moved).sum())


def brick_rule() -> list[tuple[float, np.ndarray]]:
    """Return weights and slopes, shape (27, 3), of the 27 shape functions at the Gauss points of [-1, 1]^3."""
    points, weights = np.polynomial.legendre.leggauss(3)
    value = [np.array([0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)]) for t in points]
    slope = [np.array([t - 0.5, -2.0 * t, t + 0.5]) for t in points]
    rule = []
    for i in range(3):
        for j in range(3):
            for k in range(3):
                parts = [(slope[i], value[j], value[k]), (value[i], slope[j], value[k]), (value[i], value[j], slope[k])]
                slopes = np.stack([np.einsum("a,b,c->abc", *part).ravel() for part in parts], axis=1)
                rule.append((float(weights[i] * weights[j] * weights[k]), slopes))
    return rule
