# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Lay a generated wall in another posture: a new course, the same features at the same places of the wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.centerline import make_centerline
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.segments import RETROPERITONEAL, SEGMENTS

ASCENDING_ROTATION = np.radians(20.0)
"""Turn of ascending colon and cecum about their axis from supine to prone; median 21 deg (Eur Radiol 2011)."""

_BLEND = 15.0
"""Standard deviation of the smoothing of the turn, in samples of 2 mm."""

_LENGTH_TRIALS = 2
"""Number of courses that are made to match the lengths."""


def make_posed(spec: ColonSpec, reference: Curve, seed: Sequence[int]) -> Curve:
    """Generate the course in the spec's posture, asking for other lengths until segments are as long as before.

    Tied segments stay where they are; the wall keeps its acute bends, which turn another way.
    """
    segments = dict(spec.segments)
    for _ in range(_LENGTH_TRIALS):
        posed = make_centerline(replace(spec, segments=segments), np.random.default_rng(list(seed)), reference)
        ratio = (reference.ends - reference.starts) / (posed.ends - posed.starts)
        segments = {
            name: replace(segment, length=float(segment.length * ratio[k]))
            for k, (name, segment) in enumerate(segments.items())
        }
    return posed


def repose(reference: Curve, posed: Curve) -> Curve:
    """Give a course the reference's length and segments, and frames that carry the wall over without needless twist.

    Retroperitoneal segments keep the side that faces the back; the turn between them is spread over the mobile ones.

    Args:
        reference: Course in the posture in which the wall was drawn.
        posed: Course in the other posture.
    """
    curve = Curve(posed.points * (reference.length / posed.length), reference.ends)
    return curve.turned(_roll(reference, curve))


def _roll(reference: Curve, curve: Curve) -> np.ndarray:
    """Return the turn of the frames at the curve's samples [rad], shape (n,)."""
    s = curve.s
    _, wanted, _ = reference.frame(s)
    _, normal, binormal = curve.frame(s)
    roll = np.arctan2((wanted * binormal).sum(1), (wanted * normal).sum(1))
    held = np.isin(curve.segment(s), [SEGMENTS.index(name) for name in RETROPERITONEAL])
    held_roll = np.unwrap(roll[held])
    turned = np.where(curve.segment(s[held]) >= SEGMENTS.index("ascending"), ASCENDING_ROTATION, 0.0)
    return gaussian_filter1d(np.interp(s, s[held], held_roll + turned), _BLEND, mode="nearest")
