# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A smooth space curve with arc length, frames that do not twist, and segments."""

from __future__ import annotations

from copy import copy

import numpy as np
from scipy.interpolate import CubicSpline

from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.segments import SEGMENTS


class Curve:
    """Centerline of a colon, sampled every 2 mm and interpolated between."""

    def __init__(self, points: np.ndarray, segment_ends: np.ndarray, spacing: float = 0.002) -> None:
        """Fit the curve.

        Args:
            points: Positions along the curve [m], shape (n, 3).
            segment_ends: Arc length at the end of each segment [m], shape (8,); the last is the curve's end.
            spacing: Distance of the samples [m].
        """
        chord = arc_lengths(points)
        first = CubicSpline(chord, points)
        fine = np.linspace(0, chord[-1], 20 * len(points))
        arc = arc_lengths(first(fine))
        self.length = float(arc[-1])
        self.s = np.linspace(0, self.length, round(self.length / spacing) + 1)
        self.points = first(np.interp(self.s, arc, fine))
        self.ends = np.asarray(segment_ends) * self.length / segment_ends[-1]
        self.starts = np.r_[0.0, self.ends[:-1]]
        self._spline = CubicSpline(self.s, self.points)
        self.curvature_vector = self._spline(self.s, 2)
        tangent = self._spline(self.s, 1)
        self._tangent = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
        self._normal = _untwisted_normals(self.points, self._tangent)

    @property
    def curvature(self) -> np.ndarray:
        """Curvature at the samples [1/m], shape (n,)."""
        return np.linalg.norm(self.curvature_vector, axis=1)

    def position(self, s: np.ndarray) -> np.ndarray:
        """Return positions at arc lengths ``s`` [m], shape ``(*s.shape, 3)``."""
        return self._spline(np.clip(s, 0, self.length))

    def frame(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return unit tangent, normal and binormal at ``s``, each of shape ``(*s.shape, 3)``."""
        tangent, normal = self.interpolate(s, self._tangent), self.interpolate(s, self._normal)
        tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
        normal -= (normal * tangent).sum(-1, keepdims=True) * tangent
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return tangent, normal, np.cross(tangent, normal)

    def outwards(self, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Return unit vectors across the curve at ``s``, ``theta`` [rad] from the normal towards the binormal.

        The shapes of ``s`` and ``theta`` are broadcast; the result has one more axis, of 3.
        """
        _, normal, binormal = self.frame(s)
        return np.cos(theta)[..., None] * normal + np.sin(theta)[..., None] * binormal

    def turned(self, angle: np.ndarray) -> Curve:
        """Return the same curve with its frames turned about it by ``angle`` at the samples [rad], shape (n,)."""
        curve = copy(self)
        _, normal, binormal = self.frame(self.s)
        curve._normal = np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * binormal
        return curve

    def interpolate(self, s: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Interpolate values given at the samples, shape (n, k), linearly at ``s``."""
        return np.stack([np.interp(s, self.s, values[:, k]) for k in range(values.shape[1])], -1)

    def segment(self, s: np.ndarray) -> np.ndarray:
        """Return the segment index at ``s``, int32."""
        index = np.searchsorted(self.ends, s, side="right")
        return np.minimum(index, len(SEGMENTS) - 1).astype(np.int32)

    def bounds(self, name: str) -> tuple[float, float]:
        """Return arc length at start and end of a segment [m]."""
        k = SEGMENTS.index(name)
        return float(self.starts[k]), float(self.ends[k])


def _untwisted_normals(points: np.ndarray, tangents: np.ndarray) -> np.ndarray:
    """Carry a normal along the curve without twist (double reflection, Wang et al., ACM TOG 2008)."""
    normals = np.zeros_like(tangents)
    first = np.cross(tangents[0], [1.0, 0.0, 0.0])
    normals[0] = first / np.linalg.norm(first)
    for i in range(1, len(points)):
        chord = points[i] - points[i - 1]
        scale = 2.0 / (chord @ chord)
        reflected = normals[i - 1] - scale * (chord @ normals[i - 1]) * chord
        turned = tangents[i - 1] - scale * (chord @ tangents[i - 1]) * chord
        second = tangents[i] - turned
        size = second @ second
        normals[i] = reflected if size < 1e-18 else reflected - 2.0 / size * (second @ reflected) * second
    return normals
