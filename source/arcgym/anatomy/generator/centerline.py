# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The centerline of a spec: an anatomical route, relaxed until lengths, bends and gaps are right."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.bends import acute_bends
from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.conditions import effective_segment
from arcgym.anatomy.generator.kept_courses import kept_course
from arcgym.anatomy.generator.relaxation import MOST_BENDS, relax
from arcgym.anatomy.generator.routes import control_points, sample_route
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.segments import RETROPERITONEAL, SEGMENTS

SAMPLE_SPACING = 0.005
"""Distance of the relaxed points [m]."""

_SIGMOID = SEGMENTS.index("sigmoid")
_HOLD_TIED, _HOLD_MOBILE, _HOLD_REPOSED = 0.0072, 0.003, 0.06
"""Share of the way back to the route in each iteration: of tied and mobile segments, and of tied ones that another
posture leaves in place."""
_WAVES = 0.015, 0.031
"""Standard deviations of two Gaussians whose difference of random numbers are the waves of the course [m]: their
wavelengths are 8 to 18 cm."""

_LENGTH_TRIALS = 2
"""Number of times that a course is relaxed, the second time for lengths that make up for what waves and bends took."""

_OPENINGS = 60
"""Largest number of times that too tight bends are smoothed."""

_CALM = 0.020
"""Bend radius of the course at which waves are half as large [m]: a flexure does not wind besides."""

_WAVES_FROM, _WAVES_TO = (0.05, 0.09), (0.06, 0.11)
"""Ways from the anal verge and from the pole over which the waves begin [m]."""


def make_centerline(spec: ColonSpec, rng: np.random.Generator, reference: Curve | None = None) -> Curve:
    """Generate the centerline of a spec; the result still has to pass :mod:`arcgym.anatomy.generator.acceptance`.

    Args:
        spec: Specification of the colon.
        rng: Source of randomness; as much is drawn of it for a kept course.
        reference: The same colon in another posture: it keeps the acute bends, and the tied segments their places.
    """
    lengths = {name: spec.segments[name].length for name in SEGMENTS}
    controls = control_points(spec, rng)
    if spec.course is not None:
        return _kept_curve(spec.course, spec.posture, rng)
    route = sample_route(controls, lengths, SAMPLE_SPACING)
    counts = [round(lengths[name] / SAMPLE_SPACING) for name in SEGMENTS]
    edge = np.repeat([lengths[name] / count for name, count in zip(SEGMENTS, counts, strict=True)], counts)
    tied = np.repeat([name in RETROPERITONEAL for name in SEGMENTS], counts)
    tied = np.r_[tied, tied[-1]]
    arc = np.r_[0.0, np.cumsum(edge)]
    hold, places, waving = np.where(tied, _HOLD_TIED, _HOLD_MOBILE), None, np.ones(len(tied))
    if reference is not None:
        share = np.interp(arc, np.r_[0.0, np.cumsum(list(lengths.values()))], np.r_[0.0, reference.ends])
        hold = np.where(tied, _HOLD_REPOSED, _HOLD_MOBILE)
        waving = gaussian_filter1d((~tied).astype(float), 4.0)
        route = np.where(tied[:, None], reference.position(np.asarray(share)), route)
        places = [int(np.abs(share - s).argmin()) for s in acute_bends(reference.points, reference.s)]
    wanted, radius, state = edge.copy(), base_radius(spec, arc), rng.bit_generator.state
    for _ in range(_LENGTH_TRIALS):
        rng.bit_generator.state = state
        drawn = rng.uniform(size=(MOST_BENDS, 2))
        points = relax(route, edge, radius, hold, spec, drawn, places)
        points = open_bends(add_waves(_smoothed(points), spec.waviness, rng, waving), spec.min_bend_radius)
        points *= wanted.sum() / arc_lengths(points)[-1]
        arc = arc_lengths(points)
        ends = arc[np.cumsum(counts)]
        edge = edge * np.repeat(np.array(list(lengths.values())) / np.diff(ends, prepend=0.0), counts)
    if spec.iliac_fossa is not None:
        ends[_SIGMOID] = _height_crossing(points[:, 2], arc, spec.iliac_fossa, ends[_SIGMOID : _SIGMOID + 2])
    return Curve(points, ends)


def _kept_curve(course: str, posture: str, rng: np.random.Generator) -> Curve:
    """Return a kept course, after drawing what a new one would have drawn: the rest of the colon stays the same."""
    points, ends = kept_course(course, posture)
    rng.uniform(size=(MOST_BENDS, 2))
    rng.normal(size=points.shape)
    return Curve(points, ends)


def add_waves(points: np.ndarray, size: float, rng: np.random.Generator, share: np.ndarray) -> np.ndarray:
    """Shift a course sideways by smooth random waves: real colons wind between their flexures as well.

    Args:
        points: Course, evenly spaced [m], shape (n, 3).
        size: Standard deviation of the waves in each of the two directions [m].
        rng: Source of randomness; the same numbers are drawn for every size.
        share: How much of the waves each point takes, shape (n,); none where the course has them already.
    """
    arc = arc_lengths(points)
    spacing = arc[-1] / (len(points) - 1)
    noise = rng.normal(size=(len(points), 3))
    short, long = (gaussian_filter1d(noise, wave / spacing, axis=0, mode="nearest") for wave in _WAVES)
    waves = (short - long) * size / (short - long).std()
    tangent = np.gradient(points, arc, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    bend = np.linalg.norm(np.gradient(tangent, arc, axis=0), axis=1)
    calm = 1.0 / (1.0 + (_CALM * gaussian_filter1d(bend, 0.015 / spacing)) ** 2)
    calm *= smooth_step(*_WAVES_FROM, arc) * smooth_step(*_WAVES_TO, arc[-1] - arc)
    waves -= (waves * tangent).sum(1, keepdims=True) * tangent
    return points + (share * calm)[:, None] * waves


def open_bends(points: np.ndarray, least: float) -> np.ndarray:
    """Smooth a course where it bends tighter than a radius [m], shape (n, 3); its ends stay."""
    points = points.copy()
    for _ in range(_OPENINGS):
        before, after = points[:-2] - points[1:-1], points[2:] - points[1:-1]
        span = 0.5 * (np.linalg.norm(before, axis=1) + np.linalg.norm(after, axis=1))
        tight = np.linalg.norm(before + after, axis=1) / span**2 > 1.0 / least
        if not tight.any():
            break
        share = np.convolve(tight, [0.15, 0.3, 0.15], "same")[:, None]
        points[1:-1] += share * 0.5 * (before + after)
    return points


def _height_crossing(height: np.ndarray, arc: np.ndarray, level: float, bounds: np.ndarray) -> float:
    """Return where the descending colon, followed down from its upper border, first is below a level [m]."""
    below = np.flatnonzero((height < level) & (arc < bounds[1]))
    if not len(below) or below[-1] + 1 == len(arc):
        return float(bounds[0])
    k = int(below[-1])
    return float(np.interp(level, height[k : k + 2], arc[k : k + 2]))


def _smoothed(points: np.ndarray) -> np.ndarray:
    """Smooth the course over 6 mm, and over 15 mm where it leaves the straight anal canal."""
    padded = np.pad(points, ((12, 12), (0, 0)), "reflect", reflect_type="odd")
    fine, coarse = (gaussian_filter1d(padded, width, axis=0)[12:-12] for width in (1.2, 3.0))
    blend = np.clip(2.0 - np.arange(len(points)) / 8.0, 0.0, 1.0)[:, None]
    return fine + blend * (coarse - fine)


def base_radius(spec: ColonSpec, s: np.ndarray) -> np.ndarray:
    """Return the lumen radius between folds [m] at the spec's nominal arc lengths, same shape as ``s``."""
    knots, values, start = [], [], 0.0
    for name in SEGMENTS:
        segment = effective_segment(spec, name)
        knots += [start, start + 0.5 * segment.length]
        values += [0.5 * segment.start_diameter, 0.5 * segment.middle_diameter]
        start += segment.length
    return np.interp(s, knots, values)
