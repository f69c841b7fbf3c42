# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Segments from the course of the centreline: where the flexures turn and the descending colon leaves its groove."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .errors import ColonImportError

RECTUM = 0.150
"""Length of the rectum [m]: clinically the last 15 cm above the anal verge (D'Souza et al., Ann Surg 2019)."""

CECUM = 0.064
"""Length of the caecum below the ileocaecal valve [m], about 6 cm (Gray's Anatomy)."""

FLEXURES = {"splenic": (0.037, 0.081), "hepatic": (0.012, 0.098)}
"""Where a flexure begins before and ends behind its top [m]: mean of seven colons of :mod:`arcgym.anatomy.centerline`.

They spread by 10 mm. The top comes early, for the colon goes on turning forwards (splenic) or down (hepatic) behind it.
"""

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
_GROOVE_DEPTH = 0.024
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
    found = {**_from_course(points, arc), **given}
    borders = np.array([found[name] for name in BORDERS])
    guessed: list[str] = []
    if (np.diff(np.r_[0.0, borders, arc[-1]]) < _SHORTEST_SEGMENT).any():
        guessed = [name for name in BORDERS if name not in given]
        borders = np.array([given.get(n, k * arc[-1]) for n, k in zip(BORDERS, _TYPICAL_SHARES, strict=True)])
    if (np.diff(np.r_[0.0, borders, arc[-1]]) <= 0).any():
        raise ColonImportError(f"Landmarks out of order: {borders.round(3).tolist()} m", "Correct --landmark.")
    return np.r_[borders, arc[-1]], guessed


def _from_course(points: np.ndarray, arc: np.ndarray) -> dict[str, float]:
    length, share = arc[-1], arc / arc[-1]
    splenic = _top(points * [-1, 1, 1], arc, (share > 0.30) & (share < 0.75), lateral=0.0)
    after = (arc > splenic + 0.12) & (arc < length - 0.12)
    hepatic = _top(points, arc, after, lateral=0.5) if after.any() else splenic
    tops = {"splenic": splenic, "hepatic": hepatic}
    found = {}
    for name, (before, behind) in FLEXURES.items():
        found[f"{name}_flexure_entry"] = tops[name] - before
        found[f"{name}_flexure_exit"] = tops[name] + behind
    return found | {
        "rectosigmoid": min(RECTUM, 0.2 * length),
        "sigmoid_descending": _groove_end(points, arc, splenic),
        "cecum_entry": length - min(CECUM, 0.06 * length),
    }


def _top(points: np.ndarray, arc: np.ndarray, where: np.ndarray, lateral: float) -> float:
    """Returns where the course turns at the top of a flank: high, and on the side of positive x."""
    height = points[:, 2] + lateral * np.minimum(points[:, 0] - np.quantile(points[:, 0], 0.9), 0.0)
    return float(arc[np.where(where, height, -np.inf).argmax()])


def _groove_end(points: np.ndarray, arc: np.ndarray, top: float) -> float:
    """Follows the descending colon down from the flexure until the course leaves the lateral groove."""
    step = arc[1] - arc[0]
    way = gaussian_filter1d(np.gradient(points, step, axis=0), 0.012 / step, axis=0, mode="nearest")
    steep = way[:, 2] / np.maximum(np.linalg.norm(way, axis=1), 1e-9)
    flank = (arc > top - 0.16) & (arc < top - 0.06)
    forwards = points[:, 1] - np.median(points[flank, 1])
    below = np.flatnonzero((arc < top - 0.06) & ((steep < 0.35) | (forwards > _GROOVE_DEPTH)))
    return float(arc[below[-1]]) if len(below) else 0.4 * top
