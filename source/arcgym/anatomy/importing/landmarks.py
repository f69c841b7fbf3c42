# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Segments from the course of the centreline: the tops of the flexures and heights between them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .errors import ColonImportError

RECTUM = 0.150
"""Length of the rectum [m]: clinically the last 15 cm above the anal verge (D'Souza et al., Ann Surg 2019)."""

CECUM = 0.062
"""Length of the caecum below the ileocaecal valve [m], about 6 cm (Gray's Anatomy)."""

ILIAC_CREST = (0.177, 0.2, 0.415)
"""Height of the iliac crest above the anal verge, where the descending colon becomes the sigmoid [m]; by how much it is
higher where the left flexure is; and at which height of that [m]."""

SPLENIC_FLEXURE = (0.036, 0.115)
"""How far below its top the left flexure begins and ends, as a share of the top's height above the anal verge."""

HEPATIC_FLEXURE = (0.018, 0.295)
"""The right flexure begins this far before its top [m] and ends at this share of the way down to the caecal pole."""

SPLENIC_LENGTH, HEPATIC_LENGTH = 0.115, 0.108
"""Typical lengths of the flexures [m]."""

DESCENDING_LENGTH, ASCENDING_LENGTH = 0.215, 0.145
"""Typical lengths of descending and ascending colon between the flexures and the iliac fossae [m]."""

BORDERS = (
    "rectosigmoid",
    "sigmoid_descending",
    "splenic_flexure_entry",
    "splenic_flexure_exit",
    "hepatic_flexure_entry",
    "hepatic_flexure_exit",
    "cecum_entry",
)
"""Landmarks between segments, in order."""

_SHORTEST_SEGMENT = 0.02
_LONGEST_FLEXURE = 0.16
_SLOPE_LENGTH = 0.008
_LEVEL_SLOPE = 0.35
_NEAR_CREST = 0.07
_NEAR_TOP = 0.06
_NO_TYPICAL_LENGTH = 0.06
_TYPICAL_SHARES = (0.088, 0.402, 0.532, 0.599, 0.818, 0.882, 0.963)


def find_segment_ends(points: np.ndarray, arc: np.ndarray, given: dict[str, float]) -> tuple[np.ndarray, list[str]]:
    """Finds the arc length at the end of each of the eight segments.

    Args:
        points: Centreline from the anal verge, +X right, +Y anterior, +Z cranial [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        given: Arc length [m] of landmarks that the caller knows, by names of :data:`BORDERS`.

    Returns:
        Ends [m], shape (8,), and the names of the borders that were set to typical shares of the length, because the
        course does not show them.
    """
    unknown = set(given) - set(BORDERS)
    if unknown:
        raise ColonImportError(f"Unknown landmarks {sorted(unknown)}", f"Pass --landmark with {', '.join(BORDERS)}.")
    found = {**_with_lengths(_from_course(points, arc)), **given}
    borders = np.array([found[name] for name in BORDERS])
    guessed: list[str] = []
    if (np.diff(np.r_[0.0, borders, arc[-1]]) < _SHORTEST_SEGMENT).any():
        guessed = [name for name in BORDERS if name not in given]
        borders = np.array([given.get(n, k * arc[-1]) for n, k in zip(BORDERS, _TYPICAL_SHARES, strict=True)])
    if (np.diff(np.r_[0.0, borders, arc[-1]]) <= 0).any():
        raise ColonImportError(f"Landmarks out of order: {borders.round(3).tolist()} m", "Correct --landmark.")
    return np.r_[borders, arc[-1]], guessed


def _from_course(points: np.ndarray, arc: np.ndarray) -> dict[str, float]:
    """Finds the borders by the tops of both flexures and by heights.

    The heights are means of generated colons (:mod:`arcgym.anatomy.routes`), which spread by 15 mm along the course.
    """
    length, share, height = arc[-1], arc / arc[-1], points[:, 2]
    splenic = _top(points * [-1, 1, 1], arc, (share > 0.30) & (share < 0.75), lateral=0.0)
    after = (arc > splenic + 0.12) & (arc < length - 0.12)
    hepatic = _top(points, arc, after, lateral=0.5) if after.any() else splenic
    tall = float(np.interp(splenic, arc, height) - height[0])
    level = float(np.interp(splenic, arc, height))
    right = float(np.interp(hepatic, arc, height))
    pole = float(height[arc > max(hepatic, length - 0.2)].min())
    down = right - HEPATIC_FLEXURE[1] * max(right - pole, 0.0)
    return {
        "rectosigmoid": min(RECTUM, 0.2 * length),
        "sigmoid_descending": _groove_end(arc, height, splenic, tall),
        "splenic_flexure_entry": _below(arc, height, splenic, level - SPLENIC_FLEXURE[0] * tall, _LONGEST_FLEXURE, -1),
        "splenic_flexure_exit": _below(arc, height, splenic, level - SPLENIC_FLEXURE[1] * tall, _LONGEST_FLEXURE, 1),
        "hepatic_flexure_entry": hepatic - HEPATIC_FLEXURE[0],
        "hepatic_flexure_exit": _below(arc, height, hepatic, down, _LONGEST_FLEXURE, 1),
        "cecum_entry": length - min(CECUM, 0.06 * length),
    }


def _with_lengths(found: dict[str, float]) -> dict[str, float]:
    """Moves borders towards where the next one, found better, and the typical length between them would put them."""
    typical = (
        ("splenic_flexure_exit", "splenic_flexure_entry", SPLENIC_LENGTH, 0.5),
        ("splenic_flexure_entry", "splenic_flexure_exit", -SPLENIC_LENGTH, 0.4),
        ("hepatic_flexure_exit", "cecum_entry", -ASCENDING_LENGTH, 0.3),
        ("hepatic_flexure_entry", "hepatic_flexure_exit", -HEPATIC_LENGTH, 0.7),
        ("sigmoid_descending", "splenic_flexure_entry", -DESCENDING_LENGTH, 0.2),
    )
    moved = dict(found)
    for name, other, length, share in typical:
        way = found[other] + length - found[name]
        if abs(way) < _NO_TYPICAL_LENGTH:
            moved[name] = found[name] + share * way
    return moved


def _below(arc: np.ndarray, height: np.ndarray, top: float, level: float, most: float, way: int) -> float:
    """Returns where the course, followed from a top backwards or forwards, is first below a level, or lowest."""
    near = np.flatnonzero((way * (arc - top) > 0) & (way * (arc - top) < most))[::way]
    if not len(near):
        return top
    below = near[height[near] < level]
    return float(arc[below[0] if len(below) else near[height[near].argmin()]])


def _groove_end(arc: np.ndarray, height: np.ndarray, top: float, tall: float) -> float:
    """Follows the descending colon down to the iliac crest, or to where it turns up again just above it."""
    base, slope_of_height, typical_height = ILIAC_CREST
    level = height[0] + min(base + slope_of_height * (tall - typical_height), 0.6 * tall)
    step = float(arc[1] - arc[0])
    slope = gaussian_filter1d(np.gradient(height, step), _SLOPE_LENGTH / step, mode="nearest")
    turned = (slope < _LEVEL_SLOPE) & (height < level + _NEAR_CREST * tall)
    near = np.flatnonzero((arc < top - _NEAR_TOP) & (arc > 0.3 * top))[::-1]
    if not len(near):
        return 0.5 * top
    done = near[(height[near] < level) | turned[near]]
    return float(arc[done[0] if len(done) else near[height[near].argmin()]])


def _top(points: np.ndarray, arc: np.ndarray, where: np.ndarray, lateral: float) -> float:
    """Returns where the course turns at the top of a flank: high, and on the side of positive x."""
    height = points[:, 2] + lateral * np.minimum(points[:, 0] - np.quantile(points[:, 0], 0.9), 0.0)
    return float(arc[np.where(where, height, -np.inf).argmax()])
