# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Relax a generated course by moving its points: lengths, bends and gaps between loops."""

from __future__ import annotations

from dataclasses import dataclass

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

_DRIFT = 0.01
"""Way that points may go until pairs that may be neighbors are looked for among all again [m]."""

_LENGTH_ROUNDS = 6
"""How often edges get their lengths in each iteration."""


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

    Hundreds of rounds of points that push each other amplify a difference in the last digit to a millimeter. So that a
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
    route, radius, edge = rounded(route).T.copy(), rounded(radius), rounded(edge, _EDGE_STEP)
    points, arc = route.copy(), np.r_[0.0, np.cumsum(edge)]
    need = HAUSTRAL_MARGIN * (radius[:, None] + radius[None]) + 2 * spec.wall_thickness + max(_LOOP_GAP, spec.clearance)
    loops = _Loops(need, np.abs(arc[:, None] - arc[None]) > 1.9 * need)
    sharpest = np.minimum(MAX_CURVATURE_RADIUS / radius, 1.0 / spec.min_bend_radius)
    unbend = [_unbend_of(edge, sharpest, reach) for reach in (1, 2, 4)]
    canal = np.stack([0 * arc, 0 * arc, arc])[:, :_CANAL_POINTS]
    made = None
    for k in range(_ITERATIONS):
        if spec.acute_bends and k in _CHOOSING:
            spacing, course = float(edge.mean()), points.T.copy()
            places = choose_bends(course, spacing, radius, spec) if bends is None else bends
            made = make_bends(places, spacing, radius, spec, drawn)
        if k % _NEIGHBOR_AGE == 0:
            loops.list_neighbors(points)
        points += loops.push_apart(points)
        points += hold * (route - points)
        if made:
            points += made.pull(points)
        points += _unbent(points, unbend)
        restore_lengths(points, edge, canal, _LENGTH_ROUNDS)
    points[:, :_CANAL_POINTS] = canal
    return points.T.copy()


class _Loops:
    """Points of different loops, which push each other apart where they are too near."""

    def __init__(self, need: np.ndarray, other: np.ndarray) -> None:
        """Prepare lists.

        Args:
            need: Wanted distance of each pair of points [m], shape (n, n).
            other: Whether they belong to different loops, shape (n, n).
        """
        self._need, self._other, self._listed = need, other, (need + _NEIGHBOR_REACH) ** 2
        self._seen: np.ndarray | None = None

    def list_neighbors(self, points: np.ndarray) -> None:
        """List the pairs that may come too near in the next iterations, of points (3, n)."""
        if self._seen is None or ((points - self._seen) ** 2).sum(0).max() > (0.99 * _DRIFT) ** 2:
            far = (self._need + (_NEIGHBOR_REACH + 2.0 * _DRIFT)) ** 2
            self._pairs = np.nonzero(self._other & (_square_distances(points) < far))
            self._limits, self._gaps, self._seen = self._listed[self._pairs], self._need[self._pairs], points.copy()
        a, b = self._pairs
        near = ((points[:, a] - points[:, b]) ** 2).sum(0) < self._limits
        self._a, self._b, self._gap = a[near], b[near], self._gaps[near]

    def push_apart(self, points: np.ndarray) -> np.ndarray:
        """Return the shift of each point away from those of other loops that are too near, shape (3, n)."""
        a, count = self._a, points.shape[1]
        offset = points[:, a] - points[:, self._b]
        square = (offset**2).sum(0)
        close = np.flatnonzero(square < self._gap**2)
        a, offset = a[close], offset[:, close]
        distance = np.sqrt(square[close]) + 1e-9
        overlap = self._gap[close] - distance
        total = np.bincount(a, overlap, count) + 1e-12
        push = (overlap**2 / (total[a] * distance)) * offset
        return 0.3 * np.stack([np.bincount(a, along, count) for along in push])


def _square_distances(points: np.ndarray) -> np.ndarray:
    """Return squared distances [m^2], shape (n, n), of points (3, n); a matrix product is slow on busy cores."""
    total, square = np.zeros((2, points.shape[1], points.shape[1]))
    for x in points:
        np.subtract(x[:, None], x[None], out=square)
        square *= square
        total += square
    return total


@dataclass(frozen=True)
class _Unbend:
    """Numbers of bends over some way."""

    reach: int
    """Points before and after."""
    span: np.ndarray
    """Square of the way to them [m^2], shape (n - 2 reach,)."""
    sharpest: np.ndarray
    """Largest curvature [1/m], shape (n - 2 reach,)."""


def _unbend_of(edge: np.ndarray, sharpest: np.ndarray, reach: int) -> _Unbend:
    inner = slice(reach, len(edge) - reach + 1)
    return _Unbend(reach, (reach * edge[inner]) ** 2, sharpest[reach:-reach])


def _unbent(points: np.ndarray, reaches: list[_Unbend]) -> np.ndarray:
    """Return a shift that opens bends, shape (3, n): a little everywhere, strongly where the curvature is too large.

    Over 10, 20 and 40 mm; over the longer ones neighbors move the other way, and the course does not shrink.
    """
    shift = np.zeros_like(points)
    for bend in reaches:
        reach = bend.reach
        sag = 0.5 * (points[:, : -2 * reach] + points[:, 2 * reach :]) - points[:, reach:-reach]
        curvature = 2.0 * np.sqrt((sag**2).sum(0)) / bend.span
        if reach == 1:
            excess = np.minimum(np.maximum(curvature / bend.sharpest - 1.0, 0.0), 0.9)
            shift[:, 1:-1] = sag * (_STIFFER + excess)
        else:
            excess = np.minimum(np.maximum(1.0 - bend.sharpest / np.maximum(curvature, 1e-9), 0.0), 0.9)
            part = 0.2 * sag * excess
            shift[:, reach:-reach] += part
            part *= 0.5
            shift[:, 2 * reach :] -= part
            shift[:, : -2 * reach] -= part
    return shift
