# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a generated course and wall are what their spec asks for; :mod:`generate` tries another seed if not."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.bends import acute_bends
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.validation.checks import Check
from arcgym.anatomy.validation.wall_checks import WallBounds

LENGTH_TOLERANCE = 0.08
"""Largest relative error of a segment's length."""

BEND_TOLERANCE = 0.85
"""Least radius of the centreline over the wanted one: what relaxation leaves between bends that crowd each other."""

RING_TOLERANCE = 0.32
"""Least distance of two rings on the inside of a bend over their spacing; thinner triangles would hurt the solver."""

_END_SAMPLES = 3
"""Samples at either end of a curve whose curvature does not count."""


def check_course(spec: ColonSpec, surface: Surface) -> list[Check]:
    """Check a generated centreline against its spec: bends and lengths."""
    curve = surface.curve
    sharpest = float((curve.curvature * surface.mean_radius).max())
    wanted = np.array([spec.segments[name].length for name in SEGMENTS])
    error = np.abs((curve.ends - curve.starts) / wanted - 1.0).max()
    least = 1.0 / float(curve.curvature[_END_SAMPLES:-_END_SAMPLES].max())
    checks = [
        Check("curvature times lumen radius", sharpest, 1.0, at_least=False),
        Check("least bend radius [m]", least, BEND_TOLERANCE * spec.min_bend_radius, at_least=True),
        Check("relative error of segment lengths", float(error), LENGTH_TOLERANCE, at_least=False),
    ]
    if spec.acute_bends is not None:
        off = abs(len(acute_bends(curve.points, curve.s)) - spec.acute_bends)
        checks.append(Check("acute bends more or less than wanted", off, 1, at_least=False))
    return checks


def wall_bounds(spec: ColonSpec) -> WallBounds:
    """Return the bounds of a wall that was sampled for a spec."""
    return WallBounds(RING_TOLERANCE * spec.ring_spacing, spec.clearance, 0.95 * spec.min_lumen_radius)
