# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Directions of the rays of a fisheye camera."""

from __future__ import annotations

import math

import numpy as np


def fisheye_rays(width: int, height: int, field_of_view: float, samples: int = 1) -> np.ndarray:
    """Return the ray directions of an equidistant fisheye: angle from the axis = distance from the center / f.

    Args:
        width: Picture width [px].
        height: Picture height [px].
        field_of_view: Angle from corner to corner [rad], as endoscope data sheets give it.
        samples: Rays per pixel, on a square grid where the number is a square, else on a diagonal.

    Returns:
        Unit directions in the camera's frame (−Z forward, +Y up), shape (height, width, samples, 3), float32.
    """
    focal = 0.5 * math.hypot(width, height) / (0.5 * field_of_view)
    dx, dy = _sample_offsets(samples)
    x = np.arange(width)[None, :, None] + dx - 0.5 * width
    y = 0.5 * height - (np.arange(height)[:, None, None] + dy)
    x, y = np.broadcast_arrays(x, y)
    radius = np.hypot(x, y)
    angle = radius / focal
    scale = np.sin(angle) / np.maximum(radius, 1.0e-9)
    return np.stack([x * scale, y * scale, -np.cos(angle)], axis=-1).astype(np.float32)


def pixel_angle(width: int, height: int, field_of_view: float) -> float:
    """Return the angle that one pixel spans [rad], everywhere the same along the radius."""
    return field_of_view / math.hypot(width, height)


def _sample_offsets(samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of the samples in a pixel, in [0, 1): a square grid, or a diagonal where there is no root."""
    side = math.isqrt(samples)
    if side * side == samples:
        grid = (np.arange(side) + 0.5) / side
        dx, dy = np.meshgrid(grid, grid)
        return dx.ravel(), dy.ravel()
    diagonal = (np.arange(samples) + 0.5) / samples
    return diagonal, np.roll(diagonal, samples // 2)
