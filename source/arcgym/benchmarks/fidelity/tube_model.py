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
    octant: bool = False
    """Models a half of the length and a quarter around, for loads with these symmetries: angle and pi minus angle,
    angle and its negative, both ends. Numbers of elements are those of the whole tube."""

    def nodes(self) -> np.ndarray:
        """Return the nodes' cylinder coordinates (r, angle, z), shape (Z, A, 3, 3): along, around, across the wall."""
        z = np.linspace(0.0, self.length, 2 * self.along + 1)
        angle = np.linspace(0.0, 2.0 * np.pi, 2 * self.around, endpoint=False)
        if self.octant:
            z, angle = z[: self.along + 1], angle[: self.around // 2 + 1]
        r = self.radius + self.thickness * np.array([0.0, 0.5, 1.0])
        z, angle, r = np.meshgrid(z, angle, r, indexing="ij")
        return np.stack([r, angle, z], axis=-1)

    def points(self) -> np.ndarray:
        """Return the positions of the nodes [m], shape (n, 3)."""
        r, angle, z = self.nodes().reshape(-1, 3).T
        return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)

    def bricks(self) -> np.ndarray:
        """Return the nodes of the elements, shape (E, 27).

        Raises:
            ValueError: If an octant has a number of elements that symmetry does not divide.
        """
        if self.octant and (self.around % 4 or self.along % 2):
            raise ValueError(f"An octant of {self.around} x {self.along} bricks; expected multiples of 4 and 2.")
        columns = self.nodes().shape[1]
        along, around = (self.along // 2, self.around // 4) if self.octant else (self.along, self.around)
        i, j = np.meshgrid(2 * np.arange(along), 2 * np.arange(around), indexing="ij")
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
        """Return the nodal forces of a load on the inside [N], shape (n, 3): one newton on the whole tube."""
        _, angle, z = self.nodes().reshape(-1, 3).T
        shape = self.nodes().shape[:3]
        share = np.zeros(shape)
        share[:, :, 0] = self.length / (2 * self.along) * np.pi / self.around
        share[[0, -1]] *= 0.5
        if self.octant:
            share[:, [0, -1]] *= 0.5
        return share.reshape(-1, 1) * traction(angle, z) / load_size(traction, self.length)

    def displacements(self, traction: Traction) -> np.ndarray:
        """Return the displacement of the nodes under a load of one newton [m/N], shape (n, 3)."""
        force, matrix = self.loads(traction), self.stiffness()
        free = self._free().ravel()
        moved = np.zeros(free.shape)
        moved[free] = splu(matrix[free][:, free]).solve(force.ravel()[free])
        return moved.reshape(-1, 3)

    def _free(self) -> np.ndarray:
        """Return which coordinates may move, shape (n, 3): none at held ends, none across planes of symmetry."""
        points = self.points()
        free = np.ones(points.shape, bool)
        free[(points[:, 2] < 1.0e-9) | (points[:, 2] > self.length - 1.0e-9)] = False
        if self.octant:
            free[np.abs(points[:, 0]) < 1.0e-9, 0] = False
            free[np.abs(points[:, 1]) < 1.0e-9, 1] = False
            free[points[:, 2] > 0.5 * self.length - 1.0e-9, 2] = False
        return free

    def compliance(self, traction: Traction, moved: np.ndarray | None = None) -> float:
        """Return the displacement under the load, weighted by it, for a load of one newton [m/N].

        Args:
            traction: The load.
            moved: :meth:`displacements` under it, if they are known.
        """
        moved = self.displacements(traction) if moved is None else moved
        return (8.0 if self.octant else 1.0) * float((self.loads(traction) * moved).sum())


def load_size(traction: Traction, length: float) -> float:
    """Return the size of a load integrated over angle [rad] and a tube's length [m]; no mesh has a part in it."""
    angle = np.pi * (np.arange(720) + 0.5) / 360.0
    z = length * (np.arange(1000) + 0.5) / 1000.0
    angle, z = (grid.ravel() for grid in np.meshgrid(angle, z, indexing="ij"))
    return float(np.linalg.norm(traction(angle, z), axis=1).mean() * 2.0 * np.pi * length)


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
