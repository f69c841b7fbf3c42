# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Relaxes the anatomical course until each segment has its length, no bend is too sharp and no loops touch."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .curve import Curve
from .routes import control_points, sample_route
from .segments import RETROPERITONEAL, SEGMENTS
from .spec import ColonSpec

SAMPLE_SPACING = 0.005
"""Distance of the relaxed points [m]."""

MAX_CURVATURE_RADIUS = 0.75
"""Curvature times lumen radius that relaxation aims to stay below; at 1 the inside of a bend folds over."""

HAUSTRAL_MARGIN = 1.14
"""Largest wall radius between folds over the mean radius: haustra bulge, taeniae are drawn in."""

_ITERATIONS = 700
_CANAL_POINTS = 5


def make_centerline(spec: ColonSpec, rng: np.random.Generator) -> Curve:
    """Generates the centreline of a spec; the result still has to pass :mod:`arcgym.anatomy.validate`."""
    lengths = {name: spec.segments[name].length for name in SEGMENTS}
    route = sample_route(control_points(spec, rng), lengths, SAMPLE_SPACING)
    counts = [round(lengths[name] / SAMPLE_SPACING) for name in SEGMENTS]
    edge = np.repeat([lengths[name] / count for name, count in zip(SEGMENTS, counts, strict=True)], counts)
    hold = np.repeat([0.012 if name in RETROPERITONEAL else 0.005 for name in SEGMENTS], counts)
    radius = base_radius(spec, np.r_[0.0, np.cumsum(edge)])
    points = _relax(route, edge, radius, np.r_[hold, hold[-1]], spec)
    points = gaussian_filter1d(np.pad(points, ((9, 9), (0, 0)), "reflect", reflect_type="odd"), 1.2, axis=0)[9:-9]
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    return Curve(points, arc[np.cumsum(counts)])


def base_radius(spec: ColonSpec, s: np.ndarray) -> np.ndarray:
    """Returns the lumen radius between folds [m] at the spec's nominal arc lengths, same shape as ``s``."""
    knots, values, start = [], [], 0.0
    for name in SEGMENTS:
        segment = spec.segments[name]
        knots += [start, start + 0.5 * segment.length]
        values += [0.5 * segment.start_diameter, 0.5 * segment.middle_diameter]
        start += segment.length
    return np.interp(s, knots, values)


def _relax(route: np.ndarray, edge: np.ndarray, radius: np.ndarray, hold: np.ndarray, spec: ColonSpec) -> np.ndarray:
    """Moves the points until edges have their lengths, bends are wide enough and loops are apart.

    Position-based relaxation (Mueller et al., JVCIR 2007): every constraint moves points directly; the pull back to
    the course is strong on retroperitoneal segments and weak on those that hang on a mesentery.
    """
    points = route.copy()
    arc = np.r_[0.0, np.cumsum(edge)]
    need = HAUSTRAL_MARGIN * (radius[:, None] + radius[None]) + 2 * spec.wall_thickness + 1.5 * spec.clearance
    other_loop = np.abs(arc[:, None] - arc[None]) > 1.9 * need
    canal = np.stack([0 * arc, 0 * arc, arc], 1)[:_CANAL_POINTS]
    for _ in range(_ITERATIONS):
        points += _push_apart(points, need, other_loop) + _unbend(points, edge, radius)
        points += hold[:, None] * (route - points)
        for _ in range(6):
            points[:_CANAL_POINTS] = canal
            _restore_lengths(points, edge)
    points[:_CANAL_POINTS] = canal
    return points


def _push_apart(points: np.ndarray, need: np.ndarray, other_loop: np.ndarray) -> np.ndarray:
    """Returns the shift of each point away from the points of other loops that are nearer than ``need``."""
    square = (points**2).sum(1)
    distance2 = square[:, None] + square[None] - 2.0 * points @ points.T
    a, b = np.nonzero(other_loop & (distance2 < need**2))
    offset = points[a] - points[b]
    distance = np.linalg.norm(offset, axis=1) + 1e-9
    overlap = need[a, b] - distance
    total = np.bincount(a, overlap, len(points)) + 1e-12
    push = (overlap**2 / (total[a] * distance))[:, None] * offset
    return 0.3 * np.stack([np.bincount(a, push[:, k], len(points)) for k in range(3)], 1)


def _unbend(points: np.ndarray, edge: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Returns a shift towards the neighbours' middle: a little everywhere, strong where a bend is too sharp."""
    shift = np.zeros_like(points)
    shift[1:-1] = 0.5 * (points[:-2] + points[2:]) - points[1:-1]
    curvature = 2.0 * np.linalg.norm(shift[1:-1], axis=1) / (0.5 * (edge[1:] + edge[:-1])) ** 2
    excess = np.clip(curvature * radius[1:-1] / MAX_CURVATURE_RADIUS - 1.0, 0.0, 0.9)
    shift[1:-1] *= (0.006 + excess)[:, None]
    return shift


def _restore_lengths(points: np.ndarray, edge: np.ndarray) -> None:
    """Moves both ends of every edge so that it gets its length; even edges first, then odd ones."""
    for first in (0, 1):
        a, b = points[first:-1:2], points[first + 1 :: 2]
        offset = b - a
        length = np.linalg.norm(offset, axis=1, keepdims=True)
        half = 0.5 * offset * (1.0 - edge[first::2, None] / length)
        a += half
        b -= half
