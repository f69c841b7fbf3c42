# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A discrete elastic rod in numpy, without twist: a reference for the shaft that shares no code with the simulator.

A naturally straight rod of round section whose end turns freely bears no torque, so that its shape follows from
stretching and bending alone. Nodes carry the points, edges the stretch, inner nodes the curvature (Bergou, Wardetzky,
Robinson, Audoly and Grinspun 2008, "Discrete elastic rods", section 4.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rod:
    """A naturally straight, isotropic rod of n nodes."""

    length: np.ndarray
    """Rest length of each edge [m], shape (n - 1,)."""
    rigidity: np.ndarray
    """EI at each inner node [N m^2], shape (n - 2,)."""
    stretching: float = 1.0e4
    """EA [N]: large enough that the rod keeps its length to 0.1 % under 10 N."""

    def energy(self, x: np.ndarray) -> float:
        """Return the elastic energy at the nodes' places ``x`` [m], shape (n, 3) [J].

        An edge gives EA / 2 (l / l0 - 1)^2 l0, an inner node EI / 2 (2 tan(phi / 2))^2 / l, with the angle phi between
        its edges and their mean length l.
        """
        edge, size, unit = _edges(x)
        cosine = (unit[1:] * unit[:-1]).sum(axis=1)
        stretch = 0.5 * self.stretching * ((size / self.length - 1.0) ** 2 * self.length).sum()
        return float(stretch + (self._factor() * (1.0 - cosine) / (1.0 + cosine)).sum())

    def slope(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the energy's gradient [N], shape (n, 3), and Hessian [N/m], shape (3n, 3n)."""
        edge, size, unit = _edges(x)
        gradient, hessian = np.zeros_like(x), np.zeros((len(x), 3, len(x), 3))
        across = np.eye(3) - unit[:, :, None] * unit[:, None, :]
        tension = self.stretching * (size / self.length - 1.0)
        along = (self.stretching / self.length)[:, None, None] * (np.eye(3) - across)
        first = np.arange(len(size))
        _scatter(gradient, first, (-1.0, 1.0), [tension[:, None] * unit])
        _scatter_blocks(hessian, first, (-1.0, 1.0), [[along + (tension / size)[:, None, None] * across]])
        self._bend(gradient, hessian, size, unit, across)
        return gradient, hessian.reshape(3 * len(x), -1)

    def _factor(self) -> np.ndarray:
        """Return 2 EI / l at each inner node: |2 tan(phi / 2)|^2 is 4 (1 - c) / (1 + c), with c = cos(phi)."""
        return 4.0 * self.rigidity / (self.length[1:] + self.length[:-1])

    def _bend(
        self, gradient: np.ndarray, hessian: np.ndarray, size: np.ndarray, unit: np.ndarray, across: np.ndarray
    ) -> None:
        """Add the curvature's part: that of a function of the cosine between two edges."""
        t, u = unit[:-1], unit[1:]
        c = (t * u).sum(axis=1)
        p, q = (u - c[:, None] * t) / size[:-1, None], (t - c[:, None] * u) / size[1:, None]
        one, two = -2.0 * self._factor() / (1.0 + c) ** 2, 4.0 * self._factor() / (1.0 + c) ** 3
        pp = -(_outer(t, p) + _outer(p, t)) / size[:-1, None, None] - _per(c / size[:-1] ** 2) * across[:-1]
        qq = -(_outer(u, q) + _outer(q, u)) / size[1:, None, None] - _per(c / size[1:] ** 2) * across[1:]
        pq = across[1:] / _per(size[1:] * size[:-1]) - _outer(t, q) / size[:-1, None, None]
        blocks = [
            [_per(one) * pp + _per(two) * _outer(p, p), _per(one) * pq + _per(two) * _outer(p, q)],
            [np.empty(0), _per(one) * qq + _per(two) * _outer(q, q)],
        ]
        blocks[1][0] = blocks[0][1].transpose(0, 2, 1)
        first = np.arange(len(c))
        _scatter(gradient, first, (-1.0, 1.0), [one[:, None] * p, one[:, None] * q])
        _scatter_blocks(hessian, first, (-1.0, 1.0), blocks)


def _edges(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the edges [m], their sizes [m] and directions."""
    edge = np.diff(x, axis=0)
    size = np.linalg.norm(edge, axis=1)
    return edge, size, edge / size[:, None]


def _per(values: np.ndarray) -> np.ndarray:
    return values[:, None, None]


def _outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, :, None] * b[:, None, :]


def _scatter(out: np.ndarray, first: np.ndarray, signs: tuple[float, ...], parts: list[np.ndarray]) -> None:
    """Add derivatives by successive edges, each the difference of two nodes, to those by nodes."""
    for k, part in enumerate(parts):
        for end, sign in enumerate(signs):
            np.add.at(out, first + k + end, sign * part)


def _scatter_blocks(
    out: np.ndarray, first: np.ndarray, signs: tuple[float, ...], blocks: list[list[np.ndarray]]
) -> None:
    """Add second derivatives by successive edges to those by nodes; no node pair comes twice within one sum."""
    for j, row in enumerate(blocks):
        for k, block in enumerate(row):
            for a, left in enumerate(signs):
                for b, right in enumerate(signs):
                    out[first + j + a, :, first + k + b] += left * right * block
