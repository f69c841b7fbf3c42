# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Relax a generated course by moving its points: lengths, bends and gaps between loops."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.generator.acute_bends import choose_bends, make_bends
from arcgym.anatomy.generator.rounding import rounded
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.polyline import restore_lengths

MAX_CURVATURE_RADIUS = 1.15
"""Curvature times lumen radius that relaxation aims to stay below; above 1 the inside of a bend is a crease."""

HAUSTRAL_MARGIN = 1.14
"""Largest wall radius between folds over the mean radius: haustra bulge, taeniae are drawn in."""

_ITERATIONS = 900
"""Number of iterations; our choice."""

_CHOOSING = (200, 400, 600)
"""Iterations at which acute bends are chosen anew."""

_CANAL_POINTS = 5
"""Points of the anal canal, which stays straight."""

_LOOP_GAP = 0.0075
"""Gap that relaxation leaves between the walls of two loops [m]; waves of the course take up part of it."""

MOST_BENDS = 30
"""Largest number of acute bends."""

_STIFFER = 0.006
"""Share of every bend that is opened in each iteration."""

_EDGE_STEP = 1e-9
"""What lengths of edges are rounded to [m]: there are hundreds of them, and they add up."""

_NEIGHBOR_AGE = 5
"""Iterations for which near points of other loops are kept in a list."""

_NEIGHBOR_REACH = 0.02
"""How much nearer points may come in between [m]."""


def relax(
    route: np.ndarray,
    edge: np.ndarray,
    radius: np.ndarray,
    hold: np.ndarray,
    spec: ColonSpec,
    drawn: np.ndarray,
    bends: list[int] | None = None,
) -> np.ndarray:
    """Move the points until edges have their lengths, bends are as wanted and loops are apart.

    Every constraint moves points directly (Mueller et al., JVCIR 2007); the pull back to the course is strong on
    retroperitoneal segments and weak on those that hang on a mesentery. Acute bends not given are chosen as they form.

    Hundreds of rounds of points that push each other amplify a difference in the last digit to a millimetre. So that a
    spec gives the same course on every processor, what they begin with is rounded, and they use nothing but
    additions, multiplications, divisions and square roots, which IEEE 754 defines to the bit, in a fixed order.

    Args:
        route: Course [m], shape (n, 3).
        edge: Wanted distances of its points [m], shape (n - 1,).
        radius: Lumen radius [m], shape (n,).
        hold: Share of the way back to the course in each iteration, shape (n,).
        spec: Specification of the colon.
        drawn: Random numbers from 0 to 1 for the bends' radii and angles, shape (:data:`MOST_BENDS`, 2).
        bends: Points that become acute bends; None chooses those that turn most.
    """
    route, radius, edge = rounded(route), rounded(radius), rounded(edge, _EDGE_STEP)
    points, arc = route.copy(), np.r_[0.0, np.cumsum(edge)]
    need = HAUSTRAL_MARGIN * (radius[:, None] + radius[None]) + 2 * spec.wall_thickness + max(_LOOP_GAP, spec.clearance)
    other_loop, listed = np.abs(arc[:, None] - arc[None]) > 1.9 * need, (need + _NEIGHBOR_REACH) ** 2
    sharpest = np.minimum(MAX_CURVATURE_RADIUS / radius, 1.0 / spec.min_bend_radius)
    canal = np.stack([0 * arc, 0 * arc, arc], 1)[:_CANAL_POINTS]
    made = None
    for k in range(_ITERATIONS):
        if spec.acute_bends and k in _CHOOSING:
            spacing = float(edge.mean())
            places = choose_bends(points, spacing, radius, spec) if bends is None else bends
            made = make_bends(places, spacing, radius, spec, drawn)
        if k % _NEIGHBOR_AGE == 0:
            a, b = np.nonzero(other_loop & (_square_distances(points) < listed))
            gap = need[a, b]
        points += _push_apart(points, a, b, gap)
        points += hold[:, None] * (route - points)
        if made:
            points += made.pull(points)
        points += _unbend(points, edge, sharpest)
        for _ in range(6):
            points[:_CANAL_POINTS] = canal
            restore_lengths(points, edge)
    points[:_CANAL_POINTS] = canal
    return points


def _square_distances(points: np.ndarray) -> np.ndarray:
    """Return squared distances [m^2], shape (n, n); a matrix product is slow on busy cores."""
    total, square = np.zeros((2, len(points), len(points)))
    for x in points.T:
        np.subtract(x[:, None], x[None], out=square)
        square *= square
        total += square
    return total


def _push_apart(points: np.ndarray, a: np.ndarray, b: np.ndarray, need: np.ndarray) -> np.ndarray:
    """Return the shift of each point away from those of other loops that are nearer than ``need``, for pairs a, b."""
    offset = points[a] - points[b]
    close = (offset**2).sum(1) < need**2
    a, offset, need = a[close], offset[close], need[close]
    distance = np.linalg.norm(offset, axis=1) + 1e-9
    overlap = need - distance
    total = np.bincount(a, overlap, len(points)) + 1e-12
    push = (overlap**2 / (total[a] * distance))[:, None] * offset
    return 0.3 * np.stack([np.bincount(a, push[:, k], len(points)) for k in range(3)], 1)


def _unbend(points: np.ndarray, edge: np.ndarray, sharpest: np.ndarray) -> np.ndarray:
    """Return a shift that opens bends: a little everywhere, strongly where the curvature is above ``sharpest``.

    Over 10, 20 and 40 mm; over the longer ones neighbours move the other way, and the course does not shrink.
    """
    shift = np.zeros_like(points)
    shift[1:-1] = _sag(points, 1) * (_STIFFER + np.maximum(_excess(points, edge, sharpest, 1), 0.0))[:, None]
    for reach in (2, 4):
        part = 0.2 * _sag(points, reach) * _relative_excess(points, edge, sharpest, reach)[:, None]
        shift[reach:-reach] += part
        shift[2 * reach :] -= 0.5 * part
        shift[: -2 * reach] -= 0.5 * part
    return shift


def _sag(points: np.ndarray, reach: int) -> np.ndarray:
    """Return the way from each point to the middle of those ``reach`` before and after it [m]."""
    return 0.5 * (points[: -2 * reach] + points[2 * reach :]) - points[reach:-reach]


def _curvature(points: np.ndarray, edge: np.ndarray, reach: int) -> np.ndarray:
    span = reach * edge[reach : len(edge) - reach + 1]
    return 2.0 * np.linalg.norm(_sag(points, reach), axis=1) / span**2


def _excess(points: np.ndarray, edge: np.ndarray, sharpest: np.ndarray, reach: int) -> np.ndarray:
    return np.clip(_curvature(points, edge, reach) / sharpest[reach:-reach] - 1.0, 0.0, 0.9)


def _relative_excess(points: np.ndarray, edge: np.ndarray, sharpest: np.ndarray, reach: int) -> np.ndarray:
    return np.clip(1.0 - sharpest[reach:-reach] / np.maximum(_curvature(points, edge, reach), 1e-9), 0.0, 0.9)
