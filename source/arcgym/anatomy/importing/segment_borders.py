# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Borders of the segments from the course of the centerline: tops of the flexures, heights between them.

The rules and where they come from: docs/importing.md, "Where segments end".
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.landmarks import BORDERS

RECTUM = 0.150
"""Length of the rectum [m]: clinically the last 15 cm above the anal verge (D'Souza et al., Ann Surg 2019)."""

CECUM = 0.062
"""Length of the cecum below the ileocecal valve [m], about 6 cm (Gray's Anatomy)."""

ILIAC_FOSSA = 0.180
"""Height above the anal verge at which the descending colon becomes the sigmoid: in the left iliac fossa, a little
below the iliac crest [m]."""

SPLENIC_FLEXURE = (0.037, 0.075)
"""How far before and after its middle the left flexure begins and ends [m]. Its middle is that of the stretches that
lie within 1 cm and within 5 cm of its top."""

HEPATIC_FLEXURE, LIMB_SHARE = 0.107, 0.185
"""Length of the right flexure [m], and where it ends: at this share of the way from the upper part of its descending
limb to the cecum. That upper part is the mean of where the limb is steep, 3 cm and 8 cm below the top."""

_SHORTEST_SEGMENT = 0.02
"""Least length of a segment [m]; where one is shorter, all borders are set to typical shares."""

_TOPS = (0.01, 0.05)
"""Depths below the top of the left flexure at which its middle is taken [m]."""

_LONGEST_TOP = 0.10
"""Half the length in which a flexure's top is looked at [m]."""

_LIMB_DROPS = (0.03, 0.08)
"""Depths below the top of the right flexure at which its descending limb is taken [m]."""

_LONGEST_LIMB = 0.16
"""Length behind that top in which the limb is looked for [m]."""

_STEEP = 0.8
"""Slope from which the limb counts as steep [m/m]."""

_SLOPE_LENGTH = 0.008
"""Standard deviation of the smoothing of slopes [m]."""

_LEVEL_SLOPE = 0.35
"""Slope below which the descending colon has turned into the sigmoid [m/m]."""

_NEAR_FOSSA = 0.07
"""How far above the iliac fossa it may have turned, as a share of the left flexure's height."""

_NEAR_TOP = 0.06
"""Least length of the descending colon [m]."""

_TYPICAL_SHARES = (0.088, 0.402, 0.532, 0.599, 0.818, 0.882, 0.963)
"""Share of the length at each border of the generator's average colon."""


def find_segment_ends(points: np.ndarray, arc: np.ndarray, given: dict[str, float]) -> tuple[np.ndarray, list[str]]:
    """Find the arc length at the end of each of the eight segments.

    Args:
        points: Centerline from the anal verge, +X right, +Y anterior, +Z cranial [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        given: Arc length [m] of landmarks that the caller knows, by names of :data:`arcgym.anatomy.landmarks.BORDERS`.

    Returns:
        Ends [m], shape (8,), and the names of the borders that were set to typical shares of the length, because the
        course does not show them.
    """
    found = {**borders_of_course(points, arc), **given}
    borders = np.array([found[name] for name in BORDERS])
    guessed: list[str] = []
    if (np.diff(np.r_[0.0, borders, arc[-1]]) < _SHORTEST_SEGMENT).any():
        guessed = [name for name in BORDERS if name not in given]
        borders = np.array([given.get(n, k * arc[-1]) for n, k in zip(BORDERS, _TYPICAL_SHARES, strict=True)])
    if (np.diff(np.r_[0.0, borders, arc[-1]]) <= 0).any():
        raise ColonImportError(f"Landmarks out of order: {borders.round(3).tolist()} m", "Correct --landmark.")
    return np.r_[borders, arc[-1]], guessed


def borders_of_course(points: np.ndarray, arc: np.ndarray, fossa: float = ILIAC_FOSSA) -> dict[str, float]:
    """Find the borders by the tops of both flexures, their limbs, and the height of the iliac fossa.

    Args:
        points: Centerline from the anal verge, +X right, +Y anterior, +Z cranial [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        fossa: Height of the iliac fossa above the verge [m].
    """
    length, share, height = arc[-1], arc / arc[-1], points[:, 2]
    splenic = _top(points * [-1, 1, 1], arc, (share > 0.30) & (share < 0.75), lateral=0.0)
    after = (arc > splenic + 0.12) & (arc < length - 0.12)
    hepatic = _top(points, arc, after, lateral=0.5) if after.any() else splenic
    left, limb = _middle_of_top(arc, height, splenic), _limb(arc, height, hepatic)
    cecum = length - min(CECUM, 0.06 * length)
    right = limb + LIMB_SHARE * max(cecum - limb, 0.0)
    return {
        "rectosigmoid": min(RECTUM, 0.2 * length),
        "sigmoid_descending": _groove_end(arc, height, splenic, fossa),
        "splenic_flexure_entry": left - SPLENIC_FLEXURE[0],
        "splenic_flexure_exit": left + SPLENIC_FLEXURE[1],
        "hepatic_flexure_entry": right - HEPATIC_FLEXURE,
        "hepatic_flexure_exit": right,
        "cecum_entry": cecum,
    }


def _middle_of_top(arc: np.ndarray, height: np.ndarray, top: float) -> float:
    """Return the middle of a flexure: a top may be flat, or have two humps, so that its highest point moves about."""
    near, level = np.abs(arc - top) < _LONGEST_TOP, np.interp(top, arc, height)
    middles = []
    for depth in _TOPS:
        high = arc[near & (height > level - depth)]
        middles.append(0.5 * (high[0] + high[-1]))
    return float(np.mean(middles))


def _limb(arc: np.ndarray, height: np.ndarray, top: float) -> float:
    """Return the mean of where the course is steep behind a top and where it is well below it."""
    near = (arc > top) & (arc < top + _LONGEST_LIMB)
    level = np.interp(top, arc, height)
    low = [arc[near & (height > level - drop)].max(initial=top) for drop in _LIMB_DROPS]
    steep = arc[near & (_slope(arc, height) < -_STEEP)]
    return float(np.mean([*low, steep[0] if len(steep) else np.mean(low)]))


def _slope(arc: np.ndarray, height: np.ndarray) -> np.ndarray:
    step = float(arc[1] - arc[0])
    return gaussian_filter1d(np.gradient(height, step), _SLOPE_LENGTH / step, mode="nearest")


def _groove_end(arc: np.ndarray, height: np.ndarray, top: float, fossa: float) -> float:
    """Follow the descending colon down to the iliac fossa, or to where it turns up again just above it."""
    tall = float(np.interp(top, arc, height) - height[0])
    level = height[0] + min(fossa, 0.6 * tall)
    turned = (_slope(arc, height) < _LEVEL_SLOPE) & (height < level + _NEAR_FOSSA * tall)
    near = np.flatnonzero((arc < top - _NEAR_TOP) & (arc > 0.3 * top))[::-1]
    if not len(near):
        return 0.5 * top
    done = near[(height[near] < level) | turned[near]]
    return float(arc[done[0] if len(done) else near[height[near].argmin()]])


def _top(points: np.ndarray, arc: np.ndarray, where: np.ndarray, lateral: float) -> float:
    """Return where the course turns at the top of a flank: high, and on the side of positive x."""
    height = points[:, 2] + lateral * np.minimum(points[:, 0] - np.quantile(points[:, 0], 0.9), 0.0)
    return float(arc[np.where(where, height, -np.inf).argmax()])
