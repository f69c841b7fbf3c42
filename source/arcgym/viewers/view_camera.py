# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pinhole camera of the outside view, placed so that a set of points fills the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

_MAX_ELEVATION = math.radians(85.0)


@dataclass(frozen=True)
class ViewCamera:
    """Pinhole camera in world coordinates."""

    eye: np.ndarray
    """Position [m], shape (3,)."""
    right: np.ndarray
    """Unit vector to the right of the picture, shape (3,)."""
    up: np.ndarray
    """Unit vector to the top of the picture, shape (3,)."""
    forward: np.ndarray
    """Unit viewing direction, shape (3,)."""
    tan_half: tuple[float, float]
    """Tangent of half the horizontal and half the vertical field of view."""
    size: tuple[int, int]
    """Width and height [px]."""

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return the pixel coordinates (x right, y down) of world points.

        Args:
            points: World positions [m], shape (K, 3).

        Returns:
            Pixel coordinates, shape (K, 2).
        """
        tangents = self.tangents(points) / np.array(self.tan_half)
        return (tangents * (1.0, -1.0) + 1.0) * 0.5 * np.array(self.size)

    def tangents(self, points: np.ndarray) -> np.ndarray:
        """Return right and up offset over depth of world points, shape (K, 2)."""
        offset = np.asarray(points, float) - self.eye
        return np.stack([offset @ self.right, offset @ self.up], axis=-1) / (offset @ self.forward)[:, None]

    def pixels_per_meter(self, point: np.ndarray) -> float:
        """Return how many pixels a meter across the picture takes at the depth of `point` (shape (3,))."""
        depth = float((np.asarray(point, float) - self.eye) @ self.forward)
        return 0.5 * self.size[0] / (self.tan_half[0] * depth)


def frame_points(
    points: np.ndarray,
    size: tuple[int, int],
    azimuth: float = 0.0,
    elevation: float = 0.0,
    distance: float = 1.4,
    margin: float = 1.06,
) -> ViewCamera:
    """Return the camera that shows all points as large as possible.

    Azimuth 0 looks from anterior (along −Y), +90° from the patient's left (along +X); elevation lifts the camera
    towards cranial (+Z).

    Args:
        points: World positions that must be seen [m], shape (K, 3).
        size: Picture width and height [px].
        azimuth: Turn around the body axis [rad].
        elevation: Height above the transverse plane [rad], within ±85°.
        distance: From the camera to the middle of the points [m]; large values flatten the perspective.
        margin: Field of view over the tightest one.

    Returns:
        The camera.

    Raises:
        ValueError: If the elevation is too steep for the picture's up direction to exist.
    """
    if abs(elevation) > _MAX_ELEVATION:
        raise ValueError(f"view elevation {math.degrees(elevation):.1f} deg is outside -85..85 deg")
    forward, right, up = _axes(azimuth, elevation)
    points = np.asarray(points, float)
    eye = 0.5 * (points.min(0) + points.max(0)) - distance * forward
    camera = ViewCamera(eye, right, up, forward, (1.0, 1.0), size)
    for _ in range(4):
        tangents = camera.tangents(points)
        middle = 0.5 * (tangents.min(0) + tangents.max(0))
        eye = camera.eye + distance * (middle[0] * right + middle[1] * up)
        camera = ViewCamera(eye, right, up, forward, (1.0, 1.0), size)
    half = np.abs(camera.tangents(points)).max(0) * margin
    per_pixel = max(half[0] / size[0], half[1] / size[1])
    return ViewCamera(eye, right, up, forward, (per_pixel * size[0], per_pixel * size[1]), size)


def _axes(azimuth: float, elevation: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    flat = math.cos(elevation)
    forward = np.array([math.sin(azimuth) * flat, -math.cos(azimuth) * flat, -math.sin(elevation)])
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return forward, right, np.cross(right, forward)
