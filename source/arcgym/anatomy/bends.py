# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Find the acute bends of a centerline; :mod:`arcgym.anatomy.generator.acute_bends` makes them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

WINDOW = 0.060
"""Length over which a bend is measured [m]: about one and a half lumen diameters."""

ACUTE = np.radians(90.0)
"""Turn of the tangent within :data:`WINDOW` above which a bend is acute [rad]; a mean radius below 38 mm."""

_SPACING = 0.002
"""Distance of the points at which a turn is taken [m]."""

_SMOOTHING = 0.005
"""Standard deviation of the smoothing of the course [m]."""


def turning(points: np.ndarray, arc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return arc lengths 2 mm apart [m] and the turn of the tangent over the window around each [rad].

    The tangent is smoothed over 5 mm, so that the noise of a segmented centerline does not count; half a window from
    either end the turn is 0.

    Args:
        points: Centerline [m], shape (n, 3).
        arc: Arc length of its points [m], shape (n,).
    """
    s = np.arange(arc[0], arc[-1], _SPACING)
    even = np.stack([np.interp(s, arc, points[:, k]) for k in range(3)], 1)
    tangent = np.gradient(gaussian_filter1d(even, _SMOOTHING / _SPACING, axis=0, mode="nearest"), axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    half, turn = round(0.5 * WINDOW / _SPACING), np.zeros(len(s))
    if len(s) > 2 * half:
        cosine = (tangent[2 * half :] * tangent[: -2 * half]).sum(1)
        turn[half:-half] = np.arccos(np.clip(cosine, -1.0, 1.0))
    return s, turn


def acute_bends(points: np.ndarray, arc: np.ndarray) -> np.ndarray:
    """Return the arc length of each acute bend [m], in order.

    A bend is a stretch in which every window of 60 mm turns by more than 90 degrees; a hairpin is one bend. This is a
    geometric count that anyone can repeat. The acute-angle flexures of radiology (Khashab et al., Endoscopy 2009) are
    counted by eye on CT colonography, without a stated length over which the angle is taken: the two agree in what
    they mean, not in a definition.
    """
    s, turn = turning(points, arc)
    edges = np.flatnonzero(np.diff(np.r_[0, turn > ACUTE, 0]))
    return np.array([s[first + np.argmax(turn[first:end])] for first, end in edges.reshape(-1, 2)])
