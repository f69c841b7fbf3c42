# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Depth of the tip in the wall under a load, against a neo-Hookean tube of quadratic bricks."""

from __future__ import annotations

import math

from arcgym.benchmarks.fidelity.indenter import PLACES, TOUCH, Curve, indent
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.benchmarks.fidelity.solid_curves import shipped_tube, solid_curve, thickness

LOADS = {"paper": (5.0, 10.0, 15.0), "in_situ": (0.5, 1.0, 1.5)}
"""Forces whose depths are compared, by tissue [N]."""
MESH = "14x12"
"""Mesh of the kept curves compared with; a coarser one, kept as well, is 4 % stiffer."""


def indentation(run: Run, material: str) -> list[Row]:
    """Measure the depth of the tip under a load, mean of the places; the row is of the load with the largest error."""
    ours = indent(run, shipped_tube(), material, thickness(material))
    depth, force = solid_curve(material, MESH)
    solid = Curve(depth[None], force[None])
    solid = Curve(solid.depth - solid.depth_at(TOUCH)[:, None], solid.force)
    name, top = f"indentation_solid_{material}", LOADS[material][-1]
    plot = Plot(name, "depth from first touch [mm]", "force [N]")
    plot.lines.append(("neo-Hookean bricks", 1.0e3 * solid.depth[0], solid.force[0]))
    for k, place in enumerate(PLACES):
        shown = (ours.depth[k] >= 0.0) & (ours.force[k] <= force[-1])
        plot.points.append((f"shipped, at a {place}", 1.0e3 * ours.depth[k][shown], ours.force[k][shown]))
    run.plots.append(plot)
    rows = []
    for load in LOADS[material]:
        value, reference = ours.depth_at(load), solid.depth_at(load)
        rows.append(relative(name, float(value.mean()), float(reference.mean()), 0.10, "m"))
    errors = ", ".join(f"{row.error:+.1%} at {load:g} N" for row, load in zip(rows, LOADS[material], strict=True))
    worst = max(rows, key=lambda row: abs(row.error) if math.isfinite(row.error) else math.inf)
    there = ours.force_at(float(solid.depth_at(top).mean()))
    note = f"{errors}; force at the bricks' depth under {top:g} N {there / top - 1.0:+.1%}"
    return [relative(name, worst.value, worst.reference, 0.10, "m", note)]
