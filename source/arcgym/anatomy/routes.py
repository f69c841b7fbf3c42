# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Anatomical control points of the centreline: the frame that the colon makes round the abdomen, supine.

Positions in metres from the anal verge, +X patient's right, +Y anterior, +Z cranial. Typical positions against the
skeleton: the sacral promontory at z = 0.13, the iliac crests at 0.20, the left flexure at 0.42, higher than the right.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from .segments import RETROPERITONEAL, SEGMENTS
from .spec import ColonSpec

SIGMOID_SHAPES: dict[str, list[tuple[float, float, float]]] = {
    "plain": [
        (0.000, -0.036, 0.142),
        (0.030, 0.004, 0.160),
        (0.052, 0.045, 0.190),
        (0.028, 0.080, 0.212),
        (-0.025, 0.085, 0.200),
        (-0.055, 0.065, 0.150),
        (-0.075, 0.045, 0.105),
        (-0.110, 0.025, 0.090),
        (-0.138, -0.008, 0.120),
    ],
    "angulated": [
        (0.000, -0.038, 0.150),
        (0.030, -0.010, 0.152),
        (0.062, 0.020, 0.165),
        (0.078, 0.055, 0.195),
        (0.052, 0.082, 0.222),
        (0.010, 0.092, 0.205),
        (-0.012, 0.092, 0.160),
        (-0.022, 0.085, 0.115),
        (-0.050, 0.070, 0.088),
        (-0.082, 0.062, 0.110),
        (-0.092, 0.058, 0.155),
        (-0.104, 0.040, 0.190),
        (-0.128, 0.010, 0.180),
    ],
    "redundant": [
        (0.004, -0.040, 0.148),
        (0.040, -0.022, 0.172),
        (0.078, 0.000, 0.165),
        (0.094, 0.034, 0.145),
        (0.070, 0.062, 0.118),
        (0.020, 0.062, 0.108),
        (-0.035, 0.058, 0.112),
        (-0.066, 0.050, 0.142),
        (-0.046, 0.048, 0.182),
        (0.004, 0.052, 0.190),
        (0.040, 0.042, 0.216),
        (0.022, 0.006, 0.236),
        (-0.030, -0.004, 0.228),
        (-0.078, 0.004, 0.212),
        (-0.108, 0.020, 0.180),
        (-0.112, 0.026, 0.140),
        (-0.130, 0.002, 0.112),
    ],
    "looped": [
        (0.002, -0.036, 0.150),
        (0.034, -0.006, 0.168),
        (0.066, 0.026, 0.160),
        (0.070, 0.060, 0.130),
        (0.034, 0.076, 0.106),
        (-0.014, 0.072, 0.110),
        (-0.040, 0.066, 0.146),
        (-0.022, 0.066, 0.188),
        (-0.002, 0.052, 0.222),
        (-0.040, 0.022, 0.238),
        (-0.078, 0.012, 0.212),
        (-0.088, 0.020, 0.168),
        (-0.106, 0.022, 0.124),
        (-0.132, 0.000, 0.118),
    ],
}
"""Courses of the sigmoid from the rectosigmoid junction to the left iliac fossa."""

TRANSVERSE_SHAPES: dict[str, list[tuple[float, float, float, float]]] = {
    "plain": [
        (-0.074, 0.053, 0.355, 0.0),
        (-0.048, 0.076, 0.352, 0.55),
        (0.000, 0.088, 0.366, 1.0),
        (0.050, 0.078, 0.347, 0.55),
        (0.086, 0.050, 0.340, 0.0),
    ],
    "redundant": [
        (-0.078, 0.050, 0.362, 0.00),
        (-0.078, 0.075, 0.352, 0.40),
        (-0.078, 0.090, 0.350, 0.80),
        (-0.070, 0.090, 0.350, 0.95),
        (-0.030, 0.090, 0.350, 0.95),
        (-0.022, 0.090, 0.350, 0.80),
        (-0.014, 0.090, 0.350, 0.25),
        (0.026, 0.090, 0.350, 0.25),
        (0.034, 0.090, 0.350, 0.80),
        (0.042, 0.090, 0.350, 0.95),
        (0.082, 0.090, 0.350, 0.95),
        (0.090, 0.090, 0.350, 0.80),
        (0.090, 0.072, 0.350, 0.40),
        (0.090, 0.052, 0.352, 0.00),
    ],
}
"""Courses of the transverse colon between the flexures: x, y, z without sag [m], and the share of the sag."""

_ROUTE_SLACK = 1.15
"""Length of the mesenteric courses before relaxation, relative to the wanted one; relaxation rounds the corners."""

_BACK = -0.02
"""Where the soft parts behind the mobile segments begin, anterior of the anal verge [m]."""

_FIXED_ROUTES: dict[str, list[tuple[float, float, float]]] = {
    "rectum": [(0.0, 0.0, 0.0), (0.0, -0.006, 0.030), (-0.004, -0.036, 0.066), (0.004, -0.050, 0.105)],
    "descending": [(-0.144, -0.026, 0.160), (-0.142, -0.045, 0.235), (-0.143, -0.050, 0.300), (-0.145, -0.052, 0.350)],
    "splenic": [(-0.140, -0.046, 0.395), (-0.115, -0.014, 0.425), (-0.088, 0.020, 0.405)],
    "hepatic": [(0.110, 0.018, 0.362), (0.140, -0.014, 0.352), (0.150, -0.030, 0.310)],
    "ascending": [(0.146, -0.030, 0.255), (0.142, -0.022, 0.200), (0.138, -0.010, 0.155)],
    "cecum": [(0.130, 0.006, 0.112), (0.118, 0.018, 0.077)],
}


def control_points(spec: ColonSpec, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Returns jittered control points of each segment [m], shape (n, 3).

    Raises:
        ValueError: The spec names an unknown course of the sigmoid.
    """
    if spec.sigmoid_shape not in SIGMOID_SHAPES:
        known = ", ".join(SIGMOID_SHAPES)
        raise ValueError(f"ColonSpec.sigmoid_shape = '{spec.sigmoid_shape}' is unknown; expected one of {known}.")
    routes = {
        **_FIXED_ROUTES,
        "sigmoid": SIGMOID_SHAPES[spec.sigmoid_shape],
        "transverse": _transverse_route(spec.transverse_shape, spec.transverse_sag),
    }
    points = {}
    for name in SEGMENTS:
        route = np.array(routes[name])
        shift = rng.normal(0.0, spec.jitter, route.shape)
        points[name] = route if name == "rectum" else route + shift
        if spec.posture == "prone" and name not in RETROPERITONEAL:
            points[name] = _flatten(points[name])
    return points


def _flatten(points: np.ndarray) -> np.ndarray:
    """Presses mobile segments back as the table does to a belly lying on it; they give way sideways and upwards."""
    depth = np.clip((points[:, 1] - _BACK) / 0.1, 0.0, None)
    moved = points.copy()
    moved[:, 0] *= 1.0 + 0.08 * depth
    moved[:, 1] = _BACK + (1.0 - 0.4 * np.clip(depth, 0, 1)) * (points[:, 1] - _BACK)
    moved[:, 2] += 0.008 * depth
    return moved


def _transverse_route(shape: str, sag: float) -> list[tuple[float, float, float]]:
    if shape not in TRANSVERSE_SHAPES:
        known = ", ".join(TRANSVERSE_SHAPES)
        raise ValueError(f"ColonSpec.transverse_shape = '{shape}' is unknown; expected one of {known}.")
    return [(x, y, top - share * sag) for x, y, top, share in TRANSVERSE_SHAPES[shape]]


def sample_route(points: dict[str, np.ndarray], lengths: dict[str, float], spacing: float) -> np.ndarray:
    """Samples the course, loops widened or narrowed until each segment has about its length.

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
        arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve(fine), axis=0), axis=1))]
        count = round(lengths[name] / spacing)
        parts.append(curve(np.interp(np.linspace(0, arc[-1], count + 1)[1:], arc, fine)))
    return np.concatenate(parts)


def _spline(points: dict[str, np.ndarray]) -> tuple[CubicSpline, dict[str, tuple[float, float]]]:
    """Returns a centripetal spline through all control points and the parameter range of each segment."""
    knots = np.concatenate([points[name] for name in SEGMENTS])
    parameter = np.r_[0.0, np.cumsum(np.sqrt(np.linalg.norm(np.diff(knots, axis=0), axis=1)))]
    firsts = np.minimum(np.cumsum([0, *(len(points[name]) for name in SEGMENTS)]), len(knots) - 1)
    bounds = {name: (parameter[firsts[k]], parameter[firsts[k + 1]]) for k, name in enumerate(SEGMENTS)}
    return CubicSpline(parameter, knots), bounds


def _arc_length(curve: CubicSpline, start: float, end: float) -> float:
    return float(np.linalg.norm(np.diff(curve(np.linspace(start, end, 400)), axis=0), axis=1).sum())


def _widen(points: np.ndarray, factor: float) -> np.ndarray:
    """Scales the distance of the inner control points from the chord between the outer two."""
    along = np.linspace(0, 1, len(points))[:, None]
    chord = points[0] + along * (points[-1] - points[0])
    return chord + factor * (points - chord)
