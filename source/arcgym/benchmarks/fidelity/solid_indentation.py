# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tube of quadratic bricks indented by a sphere: large displacements, neo-Hookean, no friction, no shell.

Total Lagrangian (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, sections 6.4 and 9.4):
P = mu (F - F^-T) + lambda ln J F^-T. A quarter of the tube suffices: the sphere moves along X, half way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from arcgym.benchmarks.fidelity.tube_model import brick_rule

PENALTY = 800.0
"""Pressure by depth of the contact over Young's modulus [1/m]: at a tenth of the modulus it gives by 0.125 mm."""
SHORTEST = 1.0e-5
"""Increment at which an indentation is given up [m]."""
SMALL = 1.0e-3
"""Force missing at a node at which an increment counts as solved [N]."""
FEW = 30
"""Newton iterations after which an increment is halved."""
LEAP = 2.0e-3
"""Largest move of a node in one iteration [m]."""


@dataclass(frozen=True)
class QuarterTube:
    """Quarter of a tube held at its ends: Y > 0, and Z > 0 from half way; finer towards the sphere."""

    length: float
    """Free length of the whole tube [m]."""
    radius: float
    """Inner radius [m]."""
    thickness: float
    """[m]."""
    around: int
    """Elements around."""
    along: int
    """Elements along."""
    across: int = 1
    """Elements through the wall."""

    def nodes(self) -> np.ndarray:
        """Return the places of the nodes, shape (Z, A, R, 3) [m]."""
        z = 0.5 * self.length * _graded(self.along)
        angle = np.pi * _graded(self.around)
        r = self.radius + self.thickness * np.linspace(0.0, 1.0, 2 * self.across + 1)
        z, angle, r = np.meshgrid(z, angle, r, indexing="ij")
        return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)

    def bricks(self) -> np.ndarray:
        """Return the nodes of the elements, shape (E, 27)."""
        number = np.arange(self.nodes()[..., 0].size).reshape(self.nodes().shape[:3])
        corners = np.meshgrid(*(2 * np.arange(k) for k in (self.along, self.around, self.across)), indexing="ij")
        offsets = np.meshgrid(range(3), range(3), range(3), indexing="ij")
        picked = (c.reshape(-1, 1) + o.reshape(1, -1) for c, o in zip(corners, offsets, strict=True))
        return number[tuple(picked)]

    def free(self) -> np.ndarray:
        """Return which coordinates may move, shape (3n,): none at the held end, none across the planes of symmetry."""
        points = self.nodes().reshape(-1, 3)
        out = np.ones(points.shape, bool)
        out[points[:, 2] > 0.5 * self.length - 1.0e-9] = False
        out[np.abs(points[:, 1]) < 1.0e-9, 1] = False
        out[points[:, 2] < 1.0e-9, 2] = False
        return out.ravel()

    def inside(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the inner nodes, shape (n,), and the area of wall each stands for by Simpson's rule [m^2], (n,)."""
        shape = self.nodes().shape[:3]
        number = np.arange(np.prod(shape)).reshape(shape)[:, :, 0].ravel()
        z, angle = 0.5 * self.length * _graded(self.along), np.pi * self.radius * _graded(self.around)
        return number, (_simpson(z)[:, None] * _simpson(angle)).ravel()


def _graded(elements: int) -> np.ndarray:
    """Return places from 0 to 1 of the nodes of quadratic elements, three times as fine at 0 as on average."""
    t = np.linspace(0.0, 1.0, elements + 1)
    ends = (t + 2.0 * t**3) / 3.0
    out = np.empty(2 * elements + 1)
    out[::2], out[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return out


def _simpson(x: np.ndarray) -> np.ndarray:
    """Return the nodes' weights of Simpson's rule over quadratic elements."""
    size, weight = x[2::2] - x[:-2:2], np.zeros(len(x))
    weight[:-2:2] += size / 6.0
    weight[1::2] += 4.0 * size / 6.0
    weight[2::2] += size / 6.0
    return weight


class Solid:
    """Neo-Hookean bricks: forces and tangent of a deformed state."""

    def __init__(self, points: np.ndarray, bricks: np.ndarray, youngs_modulus: float, poissons_ratio: float):
        """Measure the rest state: points (n, 3) [m], bricks (E, 27), modulus [Pa]."""
        self.bricks, self.count = bricks, len(points)
        self._mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
        self._lam = 2.0 * self._mu * poissons_ratio / (1.0 - 2.0 * poissons_ratio)
        self._rule = []
        for weight, slopes in brick_rule():
            jacobian = np.einsum("eai,aj->eij", points[bricks], slopes)
            gradient = slopes @ np.linalg.inv(jacobian)
            self._rule.append((weight * np.abs(np.linalg.det(jacobian)), gradient))
        unknowns = (3 * bricks[:, :, None] + np.arange(3)).reshape(len(bricks), 81)
        self._rows, self._columns = np.repeat(unknowns, 81, axis=1).ravel(), np.tile(unknowns, (1, 81)).ravel()

    def balance(self, x: np.ndarray) -> tuple[np.ndarray, sparse.csc_matrix]:
        """Return the elastic energy's gradient [N], shape (n, 3), and Hessian [N/m], at places ``x`` [m], shape (n, 3).

        Raises:
            ValueError: If an element is turned inside out.
        """
        force, blocks = np.zeros_like(x), np.zeros((len(self.bricks), 81, 81))
        for volume, gradient in self._rule:
            deformed = x[self.bricks].transpose(0, 2, 1) @ gradient
            ratio = np.linalg.det(deformed)
            if ratio.min() <= 0.0:
                raise ValueError("An element is turned inside out.")
            inverse = np.linalg.inv(deformed)
            pull = self._lam * np.log(ratio) - self._mu
            stress = self._mu * deformed + pull[:, None, None] * inverse.transpose(0, 2, 1)
            np.add.at(force, self.bricks, volume[:, None, None] * (gradient @ stress.transpose(0, 2, 1)))
            now = gradient @ inverse
            flat = now.reshape(len(now), 81)
            dots = (self._mu * volume)[:, None, None] * (gradient @ gradient.transpose(0, 2, 1))
            blocks += (self._lam * volume)[:, None, None] * (flat[:, :, None] * flat[:, None, :])
            four = blocks.reshape(-1, 27, 3, 27, 3)
            swapped = now[:, :, None, None, :] * now.transpose(0, 2, 1)[:, None, :, :, None]
            four -= (pull * volume)[:, None, None, None, None] * swapped
            for k in range(3):
                four[:, :, k, :, k] += dots
        matrix = sparse.csc_matrix((blocks.ravel(), (self._rows, self._columns)), shape=(3 * self.count,) * 2)
        return force, matrix


def press(tube: QuarterTube, modulus: float, ratio: float, sphere: float, depths: np.ndarray) -> np.ndarray:
    """Return the force on a sphere [N] at depths beyond its first touch [m].

    Args:
        tube: Quarter of a tube.
        modulus: Young's modulus [Pa].
        ratio: Poisson's ratio.
        sphere: Radius of the sphere [m].
        depths: Ascending.

    Raises:
        RuntimeError: If no equilibrium is found.
    """
    rest = tube.nodes().reshape(-1, 3)
    solid, free = Solid(rest, tube.bricks(), modulus, ratio), tube.free()
    x, forces, reached = rest.copy(), [], 0.0
    for depth in depths:
        step = depth - reached
        while reached < depth - 1.0e-12:
            step = min(step, depth - reached)
            found = _equilibrium(solid, free, tube, x, tube.radius - sphere + reached + step, sphere, PENALTY * modulus)
            if found is None:
                step *= 0.5
                if step < SHORTEST:
                    raise RuntimeError(f"The tube finds no equilibrium {reached:.4f} m deep.")
                continue
            (x, force), reached = found, reached + step
        forces.append(4.0 * force)
    return np.array(forces)


def _equilibrium(
    solid: Solid, free: np.ndarray, tube: QuarterTube, start: np.ndarray, place: float, sphere: float, stiffness: float
) -> tuple[np.ndarray, float] | None:
    """Return the nodes' places and the force along X with the sphere's center there, by Newton's method."""
    x, (inner, area) = start.copy(), tube.inside()
    for _ in range(FEW):
        try:
            missing, matrix = solid.balance(x)
        except ValueError:
            return None
        off = x[inner] - np.array([place, 0.0, 0.0])
        size = np.linalg.norm(off, axis=1)
        touching = size < sphere
        at, normal, deep = inner[touching], off[touching] / size[touching, None], sphere - size[touching]
        push = stiffness * area[touching] * deep
        missing[at] -= push[:, None] * normal
        if np.abs(missing.ravel()[free]).max() < SMALL:
            return x, float((push * normal[:, 0]).sum())
        both = normal[:, :, None] * normal[:, None, :]
        stiff = (stiffness * area[touching])[:, None, None] * both
        stiff = stiff - (push / size[touching])[:, None, None] * (np.eye(3) - both)
        unknowns = 3 * at[:, None] + np.arange(3)
        rows, columns = np.repeat(unknowns, 3, axis=1).ravel(), np.tile(unknowns, (1, 3)).ravel()
        matrix = (matrix + sparse.csc_matrix((stiff.ravel(), (rows, columns)), shape=matrix.shape)).tocsc()
        move = np.zeros(x.size)
        move[free] = splu(matrix[free][:, free]).solve(-missing.ravel()[free])
        x = x + (move * min(1.0, LEAP / np.abs(move).max())).reshape(-1, 3)
    return None
