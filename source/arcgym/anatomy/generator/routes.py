# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The route of a spec before relaxation: control points, jittered, posed, and sampled at the wanted lengths."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from arcgym.anatomy.generator.courses import FIXED_ROUTES, SIGMOID_SHAPES, STRAIGHT_CECUM, TRANSVERSE_SHAPES
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.segments import RETROPERITONEAL, SEGMENTS

_ROUTE_SLACK = 1.15
"""Length of the mesenteric courses before relaxation, relative to the wanted one; relaxation rounds the corners."""

_DESCENDING, _ASCENDING = (0.160, 0.395), (0.112, 0.310)
"""Heights between which descending and ascending colon are stretched when their flexure is raised [m]."""

_BACK = -0.02
"""Where the soft parts behind the mobile segments begin, anterior of the anal verge [m]."""


def control_points(spec: ColonSpec, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return jittered control points of each segment [m], shape (n, 3)."""
    routes = {
        **FIXED_ROUTES,
        "sigmoid": SIGMOID_SHAPES[spec.sigmoid_shape],
        "transverse": _transverse_route(spec.transverse_shape, spec.transverse_sag),
    }
    points = {}
    for name in SEGMENTS:
        route = np.array(routes[name])
        shift = rng.normal(0.0, spec.jitter, route.shape)
        points[name] = route if name == "rectum" else _raised(name, route, spec) + shift
        if name == "cecum" and spec.straight_cecum:
            points[name] = np.array(STRAIGHT_CECUM)
        if spec.posture == "prone" and name not in RETROPERITONEAL:
            points[name] = _flatten(points[name])
    return points


def _raised(name: str, route: np.ndarray, spec: ColonSpec) -> np.ndarray:
    """Lift the flexures, stretching the descending and ascending colon and carrying the transverse colon along."""
    along = np.linspace(0.0, 1.0, len(route))
    rise: dict[str, float | np.ndarray] = {
        "descending": spec.left_rise * _share(route[:, 2], *_DESCENDING),
        "splenic": spec.left_rise,
        "transverse": spec.left_rise + along * (spec.right_rise - spec.left_rise),
        "hepatic": spec.right_rise,
        "ascending": spec.right_rise * _share(route[:, 2], *_ASCENDING),
    }
    moved = route.copy()
    moved[:, 2] += rise.get(name, 0.0)
    return moved


def _share(height: np.ndarray, low: float, high: float) -> np.ndarray:
    return np.clip((height - low) / (high - low), 0.0, 1.0)


def _flatten(points: np.ndarray) -> np.ndarray:
    """Press mobile segments back as the table does to a belly lying on it; they give way sideways and upwards."""
    depth = np.clip((points[:, 1] - _BACK) / 0.1, 0.0, None)
    moved = points.copy()
    moved[:, 0] *= 1.0 + 0.08 * depth
    moved[:, 1] = _BACK + (1.0 - 0.4 * np.clip(depth, 0, 1)) * (points[:, 1] - _BACK)
    moved[:, 2] += 0.008 * depth
    return moved


def _transverse_route(shape: str, sag: float) -> list[tuple[float, float, float]]:
    return [(x, y, top - share * sag) for x, y, top, share in TRANSVERSE_SHAPES[shape]]


def sample_route(points: dict[str, np.ndarray], lengths: dict[str, float], spacing: float) -> np.ndarray:
    """Sample the course, loops widened or narrowed until each segment has about its length.

    Args:
        points: Control points of each segment [m].
        lengths: Length of each segment [m].
        spacing: Distance of the samples [m].

    Returns:
        Positions [m], shape (n, 3), ``round(length / spacing)`` intervals for each segment.
    """
    points = dict(points)
    for _ in range(12):
        curve, bounds = _spline(points)
        for name in ("sigmoid", "transverse"):
            ratio = _ROUTE_SLACK * lengths[name] / _arc_length(curve, *bounds[name])
            points[name] = _widen(points[name], ratio**0.7)
    curve, bounds = _spline(points)
    parts = [curve(np.zeros(1))]
    for name in SEGMENTS:
        fine = np.linspace(*bounds[name], 400)
        arc = arc_lengths(curve(fine))
        count = round(lengths[name] / spacing)
        parts.append(curve(np.interp(np.linspace(0, arc[-1], count + 1)[1:], arc, fine)))
    return np.concatenate(parts)


def _spline(points: dict[str, np.ndarray]) -> tuple[CubicSpline, dict[str, tuple[float, float]]]:
    """Return a centripetal spline through all control points and the parameter range of each segment."""
    knots = np.concatenate([points[name] for name in SEGMENTS])
    parameter = np.r_[0.0, np.cumsum(np.sqrt(np.linalg.norm(np.diff(knots, axis=0), axis=1)))]
    firsts = np.minimum(np.cumsum([0, *(len(points[name]) for name in SEGMENTS)]), len(knots) - 1)
    bounds = {name: (parameter[firsts[k]], parameter[firsts[k + 1]]) for k, name in enumerate(SEGMENTS)}
    return CubicSpline(parameter, knots), bounds


def _arc_length(curve: CubicSpline, start: float, end: float) -> float:
    return float(np.linalg.norm(np.diff(curve(np.linspace(start, end, 400)), axis=0), axis=1).sum())


def _widen(points: np.ndarray, factor: float) -> np.ndarray:
    """Scale the distance of the inner control points from the chord between the outer two."""
    along = np.linspace(0, 1, len(points))[:, None]
    chord = points[0] + along * (points[-1] - points[0])
    return chord + factor * (points - chord)
