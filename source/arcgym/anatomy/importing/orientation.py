# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Find the anal end, and for surfaces the file's axes, by likeness to a typical course."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import FRAMES
from arcgym.anatomy.polyline import arc_lengths

_TYPICAL_COURSE = np.array(
    [
        (0.000, 0.000, 0.000),
        (0.001, -0.042, 0.088),
        (0.036, -0.004, 0.154),
        (0.020, 0.075, 0.205),
        (-0.050, 0.075, 0.100),
        (-0.144, -0.021, 0.171),
        (-0.150, -0.048, 0.313),
        (-0.110, -0.010, 0.395),
        (-0.072, 0.073, 0.314),
        (0.012, 0.117, 0.242),
        (0.086, 0.058, 0.315),
        (0.143, -0.023, 0.302),
        (0.142, -0.020, 0.203),
        (0.118, 0.018, 0.075),
    ]
)
"""Course of a colon from the anal verge to the cecal pole [m], +X right, +Y anterior, +Z cranial (Gray's Anatomy)."""

_TYPICAL_SHARE = np.array([0.0, 0.06, 0.115, 0.19, 0.29, 0.40, 0.487, 0.55, 0.63, 0.715, 0.79, 0.86, 0.917, 1.0])
"""Share of the length at which each of these points lies."""

_LEAST_MARGIN = 0.08
"""Least difference of likeness between both readings of the ends; our choice."""

_LEAST_LIKENESS = 0.25
"""Least likeness at which the ends can be told apart; our choice."""


MIRRORED = "Left and right may be exchanged in the file: mirror it"
"""What to do where the mirror image is more like a colon."""


@dataclass(frozen=True)
class Orientation:
    """How a course lies in its file."""

    frame: str
    """Key of :data:`arcgym.anatomy.importing.formats.FRAMES`."""
    reversed: bool
    """Whether the course was found from cecum to anus."""
    likeness: float
    """Correlation with a typical course, 1 at best."""
    margin: float
    """By how much the other reading of the ends is less like it."""
    mirrored: bool
    """Whether the mirror image, on any axes that are tried, is more like a typical course: left and right may be
    exchanged in the file."""


def orient(path: np.ndarray, frame: str, ends_known: bool) -> Orientation:
    """Tell the ends apart and find the frame.

    Args:
        path: Course from one end to the other in the file's axes [m], shape (n, 3).
        frame: A key of :data:`arcgym.anatomy.importing.formats.FRAMES`, or ``auto``.
        ends_known: The caller gave an end; the path runs from anus to cecum.

    Raises:
        ColonImportError: Both readings of the ends, or no frame, are like a colon.
    """
    names = list(FRAMES) if frame == "auto" else [frame]
    readings = [False] if ends_known else [False, True]
    scores = {(name, back): likeness(path, FRAMES[name], back) for name in names for back in readings}
    name, backwards = max(scores, key=lambda key: scores[key])
    best = scores[name, backwards]
    other = max((score for (_, back), score in scores.items() if back != backwards), default=-1.0)
    mirror = max(likeness(path * [-1, 1, 1], FRAMES[name], back) for name, back in scores)
    if not ends_known and (best - other < _LEAST_MARGIN or best < _LEAST_LIKENESS):
        raise _alike(path, best, other, mirror)
    return Orientation(name, backwards, best, best - other, mirror > best + _LEAST_MARGIN)


def _alike(path: np.ndarray, best: float, other: float, mirror: float) -> ColonImportError:
    """Return the error that the ends cannot be told apart, which a file whose sides are exchanged gives, too."""
    a, b = (", ".join(f"{1e3 * value:.0f}" for value in path[k]) for k in (0, -1))
    found = (
        f"The ends at ({a}) mm and ({b}) mm cannot be told apart: likeness to a typical course {best:.2f} one way, "
        f"{other:.2f} the other"
    )
    mend = "Pass --anus X,Y,Z with the one that is the anus (and --frame for a surface)."
    if mirror < max(best + _LEAST_MARGIN, _LEAST_LIKENESS):
        return ColonImportError(found, mend)
    return ColonImportError(f"{found}; of the mirror image {mirror:.2f}", f"{MIRRORED}; if not: {mend}")


def likeness(path: np.ndarray, rotation: np.ndarray, backwards: bool) -> float:
    """Return the correlation with a typical course at equal shares of the length, 1 at best.

    Args:
        path: Course [m], shape (n, 3).
        rotation: From its axes to the patient's.
        backwards: Whether it is read from its last point.
    """
    course = (path[::-1] if backwards else path) @ rotation.T
    arc = arc_lengths(course)
    share = np.linspace(0.0, 1.0, 60)
    a = np.stack([np.interp(share, arc / arc[-1], course[:, k]) for k in range(3)], 1)
    b = np.stack([np.interp(share, _TYPICAL_SHARE, _TYPICAL_COURSE[:, k]) for k in range(3)], 1)
    a, b = a - a.mean(0), b - b.mean(0)
    return float((a * b).sum() / (np.linalg.norm(a) * np.linalg.norm(b)))
