# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a traced picture with opacity and depth into one that reads as three-dimensional."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.ndimage import gaussian_filter, shift

from arcgym.viewers.palette import to_display, to_linear

_BACKGROUND = (np.array([250, 251, 253]), np.array([214, 220, 229]))
_SHADOW = to_linear(np.array([120, 132, 152]))
_HAZE = to_linear(np.array([226, 231, 240]))
_HAZE_SHARE = 0.10


def compose(color: np.ndarray, depth: np.ndarray, far: float, depth_contrast: float) -> np.ndarray:
    """Put a traced picture on a light ground, with haze, shade between overlapping parts and a soft shadow.

    Args:
        color: Linear RGB, premultiplied, and opacity, shape (H, W, 4).
        depth: Distance to the first hit [m], shape (H, W); `far` where there is none.
        far: Depth of a miss [m].
        depth_contrast: Strength of the shade behind parts that lie in front of others, 0..1.

    Returns:
        Picture, uint8, shape (H, W, 3).
    """
    alpha = color[..., 3:]
    hit = depth < far
    rgb = _hazed(color[..., :3], alpha, depth, hit) * _depth_shade(depth, hit, depth_contrast)[..., None]
    return to_display(rgb + (1.0 - alpha) * _ground(color.shape[:2]) * _shadow(alpha[..., 0]))


def _hazed(rgb: np.ndarray, alpha: np.ndarray, depth: np.ndarray, hit: np.ndarray) -> np.ndarray:
    """Blend far parts into the ground."""
    if not hit.any():
        return rgb
    near, deep = np.percentile(depth[hit], [2, 98])
    share = _HAZE_SHARE * np.clip((depth - near) / max(deep - near, 1.0e-6), 0.0, 1.0)[..., None]
    return rgb * (1.0 - share) + _HAZE * alpha * share


def _depth_shade(depth: np.ndarray, hit: np.ndarray, contrast: float) -> np.ndarray:
    """Darken what lies behind its surroundings.

    Unsharp masking of the depth buffer (Luft, Colditz and Deussen, SIGGRAPH 2006).
    """
    if not hit.any():
        return np.ones_like(depth)
    sigma = 0.012 * depth.shape[0]
    weight = gaussian_filter(hit.astype(np.float32), sigma)
    around = gaussian_filter(np.where(hit, depth, 0.0), sigma) / np.maximum(weight, 1.0e-3)
    behind = np.where(hit, np.clip((depth - around) / 0.02, 0.0, 1.0), 0.0)
    return 1.0 - contrast * 0.75 * behind


def _shadow(alpha: np.ndarray) -> np.ndarray:
    """Return the factor of the ground's brightness under a soft shadow, shape (H, W, 3)."""
    height = alpha.shape[0]
    cast = shift(alpha, (0.030 * height, 0.022 * height), order=0, mode="nearest", prefilter=False)
    share = 0.55 * gaussian_filter(cast, 0.020 * height)[..., None]
    return 1.0 - share + share * _SHADOW


@lru_cache(maxsize=4)
def _ground(size: tuple[int, int]) -> np.ndarray:
    """Light gradient, brightest a little above the middle, linear RGB, shape (H, W, 3)."""
    y, x = np.mgrid[0 : size[0], 0 : size[1]]
    distance = np.hypot(x / size[1] - 0.5, (y / size[0] - 0.42) * 1.1)
    share = np.clip(distance / 0.75, 0.0, 1.0)[..., None] ** 1.6
    return to_linear(_BACKGROUND[0] * (1.0 - share) + _BACKGROUND[1] * share)
