# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Smooth tube swept along the links of the scope."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

_CAP_RINGS = 5


class ScopeTube:
    """Vertices of a round-ended tube through all links; the topology never changes, only the positions do.

    Attributes:
        faces: Triangles, shape (F, 3), int32, wound so that normals point outwards.
        arc: Distance of each vertex from the proximal end, along the scope [m], shape (K,), float32.
        length: Total length [m].
    """

    def __init__(self, link_length: np.ndarray, link_radius: np.ndarray, rings_per_link: int = 4, sides: int = 16):
        """Lay out the rings.

        Args:
            link_length: Length of each link [m], shape (L,).
            link_radius: Radius of each link [m], shape (L,).
            rings_per_link: Rings swept along one link.
            sides: Vertices of a ring.
        """
        link_length = np.asarray(link_length, float)
        ends = np.concatenate([[0.0], np.cumsum(link_length)])
        centers = 0.5 * (ends[1:] + ends[:-1])
        self.length = float(ends[-1])
        self._knots = np.concatenate([[0.0], centers, [self.length]])
        self._half_length = 0.5 * link_length
        self._rings, scale, self._tilt = _ring_profile(self.length, link_radius, len(link_length) * rings_per_link)
        self._radius = np.interp(self._rings, centers, np.asarray(link_radius, float)) * scale
        self._angle = np.arange(sides) * 2.0 * np.pi / sides
        self.arc = np.repeat(self._rings, sides).astype(np.float32)
        self.faces = _tube_faces(len(self._rings), sides)

    def sweep(self, position: np.ndarray, quaternion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the tube for the given link poses.

        Args:
            position: Middle of each link [m], shape (L, 3).
            quaternion: Link orientation (x, y, z, w), local +Z towards the tip, shape (L, 4).

        Returns:
            Vertices [m] and unit normals, both shape (K, 3), float32.
        """
        side, axis = _link_axes(np.asarray(quaternion, float))
        position = np.asarray(position, float)
        first = position[:1] - self._half_length[0] * axis[:1]
        last = position[-1:] + self._half_length[-1] * axis[-1:]
        tangents = np.concatenate([axis[:1], axis, axis[-1:]])
        curve = CubicHermiteSpline(self._knots, np.concatenate([first, position, last]), tangents)
        side = np.concatenate([side[:1], side, side[-1:]])
        side = _interpolate(self._rings, self._knots, side)
        return self._rings_around(curve(self._rings), curve(self._rings, 1), side)

    def _rings_around(self, middle: np.ndarray, tangent: np.ndarray, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        tangent = _unit(tangent)
        side = _unit(side - tangent * np.sum(side * tangent, axis=1, keepdims=True))
        third = np.cross(tangent, side)
        angle = self._angle[None, :, None]
        around = np.cos(angle) * side[:, None] + np.sin(angle) * third[:, None]
        vertices = middle[:, None] + self._radius[:, None, None] * around
        tilt = self._tilt[:, None, None]
        normals = np.sqrt(1.0 - tilt**2) * around + tilt * tangent[:, None]
        return vertices.reshape(-1, 3).astype(np.float32), normals.reshape(-1, 3).astype(np.float32)


def _ring_profile(length: float, link_radius: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return arc length, radius scale and axial part of the normal of each ring, with quarter-circle ends."""
    turn = np.linspace(0.5 * np.pi, 0.0, _CAP_RINGS)
    first, last = 0.6 * float(link_radius[0]), 0.6 * float(link_radius[-1])
    body = np.linspace(first, length - last, count + 1)[1:-1]
    rings = np.concatenate([first * (1.0 - np.sin(turn)), body, length - last * (1.0 - np.sin(turn[::-1]))])
    scale = np.concatenate([np.cos(turn), np.ones(len(body)), np.cos(turn[::-1])])
    tilt = np.concatenate([-np.sin(turn), np.zeros(len(body)), np.sin(turn[::-1])])
    return rings, np.maximum(scale, 1.0e-3), tilt


def _tube_faces(rings: int, sides: int) -> np.ndarray:
    ring, side = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    beside = (side + 1) % sides
    a, b, c, d = (r * sides + s for r, s in ((ring, side), (ring, beside), (ring + 1, beside), (ring + 1, side)))
    return np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 2).reshape(-1, 3).astype(np.int32)


def _link_axes(quaternion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and third column of each rotation matrix, both shape (L, 3)."""
    x, y, z, w = quaternion.T
    side = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=-1)
    axis = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], axis=-1)
    return side, axis


def _interpolate(query: np.ndarray, knots: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(query, knots, values[:, k]) for k in range(values.shape[1])], axis=-1)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1.0e-12)
