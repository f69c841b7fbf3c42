# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A rod pushed quasi-statically into a tube: contact by a stiff penalty or a compliance, Coulomb friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from arcgym.benchmarks.fidelity.rod import Rod
from arcgym.benchmarks.fidelity.rod_surface import Distance, GridSurface

Compliance = Callable[[np.ndarray], np.ndarray]
"""Displacement of the wall along its normals by unit forces there [m/N], (c, c), of contacts at grid places (c, 2)."""
HOLD = 1.0e-3
"""Residual force on a node at which an increment counts as solved [N]."""
FEW = 40
"""Newton iterations after which an increment is halved."""
SHORTEST = 1.0e-6
"""Increment at which a push is given up [m]."""
NEAR = 1.5e-3
"""How far from touching nodes are looked at [m]."""
TINY = 1.0e-15
"""Keeps a length off zero [m]."""
LEAP = 2.0e-3
"""Largest move of a node in one iteration [m]."""


@dataclass(frozen=True)
class PushSettings:
    """Contact, friction and guide of a push."""

    friction: float = 0.1
    """Coulomb coefficient."""
    stiffness: float = 2.0e4
    """Penalty of a node's contact [N/m]: 1 N gives by 0.05 mm."""
    hold: float = 2.0e4
    """Stiffness along the wall of a contact that friction holds [N/m]."""
    guide: float = 4.0e4
    """Sideways foundation of the shaft outside, per length [N/m^2], as the introducer's springs."""
    guide_height: float = 0.005
    """Height up to which it is guided [m]."""
    drag: float = 2.0
    """Spring from a node to where it was an increment before, across the rod [N/m]. It carries the rod through snaps,
    where no equilibrium is near; there it grows until one is found, and falls again in the increments after."""
    increment: float = 5.0e-4
    """Way of the base between two equilibria [m]."""


@dataclass
class Path:
    """What a push gave at each increment."""

    inserted: list[float] = field(default_factory=list)
    """Inserted length, up to the front of the tip [m]."""
    force: list[float] = field(default_factory=list)
    """Push on the base [N]."""
    tip: list[np.ndarray] = field(default_factory=list)
    """Front of the tip [m]."""
    shape: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Nodes at the end [m]."""
    normal: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Normal forces at the end [N]."""


class RodPush:
    """A straight rod below the tube, whose base is then pushed along Z."""

    def __init__(
        self,
        rod: Rod,
        radius: np.ndarray,
        front: float,
        surface: GridSurface,
        settings: PushSettings,
        compliance: Compliance | None = None,
        load: float = 0.0,
    ):
        """Lay the rod along Z.

        Args:
            rod: The rod, base first.
            radius: Distance of each node from the wall when they touch [m], shape (n,).
            front: Distance of the tip's front from the last node [m].
            surface: Inside of the wall.
            settings: Contact, friction and guide.
            compliance: Of the wall; None for a rigid one.
            load: Push back on the last node, along the last edge [N].
        """
        self.rod, self.radius, self.front = rod, radius, front
        self.surface, self.settings, self.compliance, self.load = surface, settings, compliance, load
        self.total = float(rod.length.sum())
        self.x = np.zeros((len(radius), 3))
        self.slide = np.zeros_like(self.x)
        """Elastic displacement along the wall that friction holds [m]."""
        self.normal_force = np.zeros(len(radius))
        self.iterations = 0

    def place(self, inserted: float) -> None:
        """Lay it straight with the tip's front at a height [m]."""
        self.x[:, 2] = np.r_[0.0, np.cumsum(self.rod.length)] - self.total + inserted - self.front
        self.inserted = inserted

    def push(self, depth: float) -> Path:
        """Push until a length is inserted [m]."""
        path, step, drag = Path(), self.settings.increment, self.settings.drag
        while self.inserted < depth - 1.0e-9:
            force = self._advance(min(step, depth - self.inserted), drag)
            if force is None:
                step, drag = 0.5 * step, 3.0 * drag
                if step < SHORTEST:
                    raise RuntimeError(f"The rod finds no equilibrium at {self.inserted:.4f} m.")
                continue
            step, drag = min(self.settings.increment, 2.0 * step), max(self.settings.drag, drag / 3.0)
            direction = self.x[-1] - self.x[-2]
            path.inserted.append(self.inserted)
            path.force.append(force)
            path.tip.append(self.x[-1] + self.front * direction / np.linalg.norm(direction))
        path.shape, path.normal = self.x.copy(), self.normal_force.copy()
        return path

    def _advance(self, way: float, drag: float) -> float | None:
        """Move the base and find the equilibrium; the push [N], or None if there is none."""
        before, x = self.x, self.x.copy()
        direction = np.gradient(before, axis=0)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        x += way * direction
        x[:2] = before[:2] + [0.0, 0.0, way]
        for _ in range(FEW):
            self.iterations += 1
            residual, matrix, slide, normal = self._balance(x, before, direction, drag)
            if np.abs(residual[2:]).max() < HOLD:
                self.x, self.slide, self.normal_force = x, slide, normal
                self.inserted += way
                return float(residual[:2, 2].sum())
            move = np.zeros_like(x)
            move[2:] = -np.linalg.solve(matrix[6:, 6:], residual[2:].ravel()).reshape(-1, 3)
            x = x + move * min(1.0, LEAP / np.abs(move).max())
        return None

    def _balance(
        self, x: np.ndarray, before: np.ndarray, direction: np.ndarray, drag: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the force missing at each node, its slope by the nodes, the new slide and the normal forces."""
        law, n = self.settings, len(x)
        residual, matrix = self.rod.slope(x)
        residual[-1] += self.load * direction[-1]
        blocks = matrix.reshape(n, 3, n, 3)
        node = np.arange(n)
        across = np.eye(3) - direction[:, :, None] * direction[:, None, :]
        residual += drag * np.einsum("nij,nj->ni", across, x - before)
        blocks[node, :, node] += drag * across
        outside = x[:, 2] < law.guide_height
        weight = law.guide * np.r_[self.rod.length, 0.0] * outside
        residual[:, :2] += weight[:, None] * x[:, :2]
        for k in range(2):
            blocks[node, k, node, k] += weight
        wall = self.surface.project(x, float(self.radius.max()) + NEAR)
        inside = (x[wall.index, 2] > 0.0) & (wall.size < self.radius[wall.index])
        slide, force = np.zeros_like(x), np.zeros(n)
        touching, pushing, stiffness = self._normal_forces(wall, np.flatnonzero(inside))
        at, normal = wall.index[touching], wall.normal[touching]
        force[at] = pushing
        residual[at] -= pushing[:, None] * normal
        blocks[at, :, at] -= pushing[:, None, None] * wall.turn[touching]
        slope = np.einsum("ab,bj->abj", stiffness, normal)
        blocks[np.ix_(at, range(3), at, range(3))] += np.einsum("ai,abj->aibj", normal, slope)
        trial, secant, slips = self._return_mapping(x - before, at, pushing, normal)
        residual[at] += secant[:, None] * trial
        slide[at] = (secant / law.hold)[:, None] * trial
        unit = trial / np.maximum(np.linalg.norm(trial, axis=1), TINY)[:, None]
        along = (
            np.eye(3)
            - normal[:, :, None] * normal[:, None, :]
            - slips[:, None, None] * unit[:, :, None] * unit[:, None]
        )
        blocks[at, :, at] += secant[:, None, None] * along
        pull = law.friction * slips[:, None] * unit
        blocks[np.ix_(at, range(3), at, range(3))] -= np.einsum("ai,abj->aibj", pull, slope)
        return residual, matrix, slide, force

    def _normal_forces(self, wall: Distance, near: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the nodes that push among those near, their forces [N] and the slope by their depths [N/m].

        A contact gives by its penalty and with the wall: gap + (1 / k + C) f = 0 where f > 0.
        """
        while True:
            given = np.eye(len(near)) / self.settings.stiffness
            if self.compliance is not None and len(near):
                given = given + self.compliance(wall.place[near])
            stiffness = np.linalg.inv(given)
            force = stiffness @ (self.radius[wall.index[near]] - wall.size[near])
            if not len(near) or force.min() >= 0.0:
                return near, force, stiffness
            near = near[force > 0.0]

    def _return_mapping(
        self, way: np.ndarray, at: np.ndarray, force: np.ndarray, normal: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return each contact's displacement along the wall [m], friction over it [N/m], and whether it slips.

        A spring along the wall that slides on at Coulomb's limit (Wriggers 2006, Computational Contact Mechanics, 5.2).
        """
        moved = self.slide[at] + way[at]
        trial = moved - (moved * normal).sum(axis=1, keepdims=True) * normal
        limit = self.settings.friction * force / np.maximum(np.linalg.norm(trial, axis=1), TINY)
        return trial, np.minimum(limit, self.settings.hold), (limit < self.settings.hold).astype(float)
