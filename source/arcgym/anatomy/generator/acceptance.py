# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a generated course and wall are what their spec asks for; :mod:`generate` tries another draw if not."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.course_measures import measure_course
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.validation.checks import Check
from arcgym.anatomy.validation.wall_checks import WallBounds

LENGTH_TOLERANCE = 0.10
"""Largest relative error of a segment's length."""

BEND_TOLERANCE = 0.80
"""Least bend radius over the wanted one: what relaxation leaves between bends that crowd each other."""

RING_DISTANCE = 0.003
"""Least distance of two rings at the middle of the wall [m]: nearer ones jitter at rest."""


def check_course(spec: ColonSpec, surface: Surface) -> list[Check]:
    """Check a generated centerline against its spec: bends and lengths."""
    curve = surface.curve
    wanted = np.array([spec.segments[name].length for name in SEGMENTS])
    error = np.abs((curve.ends - curve.starts) / wanted - 1.0).max()
    measured = measure_course(curve.points)
    least = BEND_TOLERANCE * spec.min_bend_radius
    checks = [
        Check("least bend radius [m]", measured.bend_radius_least, least, at_least=True),
        Check("relative error of segment lengths", float(error), LENGTH_TOLERANCE, at_least=False),
    ]
    if spec.acute_bends is not None:
        off = abs(measured.acute_bends - spec.acute_bends)
        checks.append(Check("acute bends more or less than wanted", off, 1, at_least=False))
    return checks


def wall_bounds(spec: ColonSpec) -> WallBounds:
    """Return the bounds of a wall that was made for a spec."""
    return WallBounds(RING_DISTANCE, spec.clearance, 0.7 * spec.min_lumen_radius)
