# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make acute bends while a course relaxes: where it turns most, draw it towards an arc with straight legs.

:mod:`arcgym.anatomy.bends` counts the bends of a finished centerline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.bends import WINDOW
from arcgym.anatomy.generator.rounding import rounded
from arcgym.anatomy.generator.spec import ColonSpec

SHARPEST = 1.15
"""Largest curvature times lumen radius of a made bend: real flexures fold, at 0.85 to 1 times the lumen's radius at the
5th percentile of the course."""

WIDEST = 0.036
"""Largest radius of an arc that turns 90 degrees within the window of :func:`arcgym.anatomy.bends.acute_bends` [m]."""

_ANGLES = np.radians(100.0), np.radians(165.0)
"""Least and largest angle by which an arc turns [rad]."""

_WIDER = 1.0, 1.5
"""Least and largest radius of an arc over the least that spec and lumen allow."""

_REACH = 0.050
"""Length of the course before and behind an arc's middle that it shapes [m]."""

_APART = 0.085
"""Least distance of two bends along the course [m]."""

_STIFFNESS = 0.4
"""Share of the way to the wanted shape in each iteration."""

_FROM_END = 0.08
"""Least distance of a bend from either end [m]."""

_LEAST_TURN = np.radians(17.0)
"""Least turn of the course where a bend is made [rad]."""


@dataclass(frozen=True)
class BendTargets:
    """Bends to make."""

    index: np.ndarray
    """Points that each bend shapes, shape (K, n), int."""
    shape: np.ndarray
    """Their wanted positions in the bend's plane, relative to their mean [m], shape (K, n, 2)."""

    def pull(self, points: np.ndarray) -> np.ndarray:
        """Return a shift of every point towards the shape of its bend (shape matching, Mueller et al., TOG 2005).

        Points and shift have shape (3, n).
        """
        count = points.shape[1]
        here = points.T[self.index]
        middle = here.mean(1, keepdims=True)
        along, across = (self.shape[..., k, None] for k in range(2))
        first, second = _nearest_axes((along * (here - middle)).sum(1), (across * (here - middle)).sum(1))
        target = along * first[:, None] + across * second[:, None] + middle
        way = (_STIFFNESS * (target - here)).reshape(-1, 3)
        index = self.index.ravel()
        shift = np.stack([np.bincount(index, way[:, k], count) for k in range(3)])
        return shift / np.maximum(np.bincount(index, minlength=count), 1)


def _nearest_axes(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the orthonormal pairs of vectors nearest to pairs of vectors, shape (K, 3) each.

    The rows of (A A^T)^(-1/2) A, where a and b are the rows of A. By arithmetic and square roots alone, which round in
    the same way everywhere, see :func:`arcgym.anatomy.generator.relaxation.relax`.
    """
    aa, bb, ab = ((x * y).sum(1, keepdims=True) for x, y in ((a, a), (b, b), (a, b)))
    area = np.sqrt(np.maximum(aa * bb - ab * ab, 1e-30))
    scale = area * np.sqrt(aa + bb + 2.0 * area)
    return ((bb + area) * a - ab * b) / scale, ((aa + area) * b - ab * a) / scale


def choose_bends(points: np.ndarray, spacing: float, radius: np.ndarray, spec: ColonSpec) -> list[int]:
    """Return the points that turn most, far enough from each other, where the lumen is narrow enough for a bend.

    Args:
        points: Course [m], shape (n, 3).
        spacing: Distance of its points [m].
        radius: Lumen radius at them [m], shape (n,).
        spec: Asks for the number of bends and the least radius.
    """
    turn = gaussian_filter1d(_turn(points, round(0.5 * WINDOW / spacing)), 1.0)
    ends, apart = round(_FROM_END / spacing), round(_APART / spacing)
    turn[:ends] = turn[-ends:] = 0.0
    turn[_arc_radius(radius, spec) > WIDEST] = 0.0
    chosen: list[int] = []
    while len(chosen) < (spec.acute_bends or 0) and turn.max() > _LEAST_TURN:
        chosen.append(int(turn.argmax()))
        turn[max(0, chosen[-1] - apart) : chosen[-1] + apart + 1] = 0.0
    return chosen


def make_bends(
    places: list[int], spacing: float, radius: np.ndarray, spec: ColonSpec, drawn: np.ndarray
) -> BendTargets:
    """Return the bends at the given points.

    Args:
        places: Points in the middle of the bends.
        spacing: Distance of the course's points [m].
        radius: Lumen radius at them [m], shape (n,).
        spec: Asks for the least radius.
        drawn: Random numbers from 0 to 1 for radius and angle of the bends along the course, shape (k, 2).
    """
    reach = round(_REACH / spacing)
    index = np.array(places, int)[:, None] + np.arange(-reach, reach + 1)
    order, shapes = np.argsort(np.argsort(places)), []
    for k, place in enumerate(places):
        wide, turn = drawn[order[k] % len(drawn)]
        size = float(_arc_radius(radius[place], spec)) * (_WIDER[0] + wide**2 * (_WIDER[1] - _WIDER[0]))
        angle = _ANGLES[0] + turn * (_ANGLES[1] - _ANGLES[0])
        shapes.append(_arc_with_legs(min(size, WIDEST), angle, reach, spacing))
    return BendTargets(index, rounded(np.array(shapes).reshape(-1, 2 * reach + 1, 2)))


def _arc_radius(radius: np.ndarray, spec: ColonSpec) -> np.ndarray:
    return np.maximum(spec.min_bend_radius, radius / SHARPEST)


def _turn(points: np.ndarray, half: int) -> np.ndarray:
    edge = np.diff(points, axis=0)
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    turn = np.zeros(len(points))
    turn[half:-half] = np.arccos(np.clip((edge[2 * half - 1 :] * edge[: len(edge) - 2 * half + 1]).sum(1), -1.0, 1.0))
    return turn


def _arc_with_legs(radius: float, turn: float, reach: int, spacing: float) -> np.ndarray:
    """Return an arc with a straight leg at either end, in its plane, about its mean [m], shape (2 reach + 1, 2)."""
    step, fine = spacing / 20, np.arange(-20 * reach, 20 * reach + 1) * spacing / 20
    curvature = np.where(np.abs(fine) < 0.5 * turn * radius, 1.0 / radius, 0.0)
    angle = np.cumsum(gaussian_filter1d(curvature, 0.002 / step)) * step
    points = np.cumsum(np.stack([np.cos(angle), np.sin(angle)], 1), axis=0)[::20] * step
    return points - points.mean(0)
