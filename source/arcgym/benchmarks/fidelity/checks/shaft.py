# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bending, buckling and twist of the shaft in free air against beam theory."""

from __future__ import annotations

import math

import numpy as np

from arcgym.benchmarks.fidelity import beams
from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.benchmarks.fidelity.shaft import LINKS, beam, end_places, rigidity, shaft_in_air, twist_angle

PLANES = ("X", "Y")
"""Directions of the sideways load. Hinges about Y bend towards X, hinges about X towards Y."""
GUIDE = 2000.0
"""Stiffness of a guide that holds one point of the shaft on the axis [N/m]."""
TWIST_RIGIDITY = 0.93 * 78.0 * 1.0e-4 * 180.0 / math.pi
"""GJ [N m^2]: CF-140S, 68 to 88 N cm^2/deg at 24 C, less 7 % at 37 C (Flexural and torsional rigidity of
colonoscopes)."""


def cantilever(run: Run) -> list[Row]:
    """Measure the end deflection under a dead load across the shaft, in both planes."""
    sizes = (0.05, 1.0, 2.0, 4.0)
    sim, loads = shaft_in_air(run, 2 * len(sizes))
    stiff = rigidity(sim)
    length, offset = beam(sim)
    forces = [size * stiff / length**2 for size in 2 * sizes]
    for world, force in enumerate(forces):
        loads.point[world, -1, 2] = offset
        loads.force[world, -1, world // len(sizes)] = force
    settle(sim)
    end = end_places(sim, offset)
    deflection = [float(end[world, world // len(sizes)]) for world in range(len(forces))]
    exact = [beams.elastica_deflection(f, length, stiff) for f in forces]
    ratio = np.array(deflection) / length
    fine = np.linspace(0.01, sizes[-1], 50)
    plot = Plot("cantilever", "F L² / EI", "end deflection / L")
    plot.lines.append(("elastica", fine, [beams.elastica_deflection(f, 1.0, 1.0) for f in fine]))
    plot.lines.append(("F L³ / 3 EI", [0.0, 1.5], [0.0, 0.5]))
    plot.points += [(f"towards {p}", sizes, ratio[i * len(sizes) :][: len(sizes)]) for i, p in enumerate(PLANES)]
    run.plots.append(plot)
    small = [beams.small_deflection(f, length, stiff) for f in forces]
    return [
        worst_plane("cantilever_small", deflection, small, [0, len(sizes)], 0.02, "m"),
        worst_plane("cantilever_large", deflection, exact, [len(sizes) - 1, -1], 0.02, "m"),
    ]


def graded(run: Run) -> list[Row]:
    """Measure the end deflection of a shaft that is softer towards its end, under a small load, in both planes."""
    from arcgym.assets import GradingCfg

    grading = GradingCfg(passive_length=0.1, distal_length=0.3)
    sim, loads = shaft_in_air(run, 2, endoscope={"grading": grading})
    stiff = rigidity(sim)
    length, offset = beam(sim)
    force = 0.05 * stiff / length**2
    for world in range(2):
        loads.point[world, -1, 2] = offset
        loads.force[world, -1, world] = force
    settle(sim)
    end = end_places(sim, offset)
    deflection = [float(end[world, world]) for world in range(2)]
    parts = [
        (grading.passive_length, grading.passive_share * stiff),
        (grading.distal_length, grading.distal_share * stiff),
        (length, stiff),
    ]
    exact = beams.graded_deflection(force, length, parts)
    return [worst_plane("cantilever_graded", deflection, [exact, exact], [0, 1], 0.02, "m")]


def worst_plane(
    name: str, value: list[float], reference: list[float], places: list[int], bound: float, unit: str
) -> Row:
    """Return the row of the plane with the larger error; the other's error goes into the note."""
    rows = [relative(name, value[k], reference[k], bound, unit) for k in places]
    errors = ", ".join(f"{row.error:+.2%} towards {plane}" for row, plane in zip(rows, PLANES, strict=True))
    worst = max(rows, key=lambda row: abs(row.error))
    return relative(name, worst.value, worst.reference, bound, unit, errors)


def torsion(run: Run) -> list[Row]:
    """Measure the twist of the straight shaft between base and tip under a torque on its tip."""
    torque = 0.03
    sim, loads = shaft_in_air(run, 1)
    loads.torque[0, -1, 2] = torque
    settle(sim)
    lengths = np.r_[0.0, 0.0, np.cumsum(sim.endoscope.stage.link_length[1:-1])]
    twist = np.array([twist_angle(sim, link) for link in range(LINKS)]) - twist_angle(sim, 0)
    reference = torque * lengths / TWIST_RIGIDITY
    plot = Plot("torsion", "distance from the base [m]", "twist [mrad]")
    plot.lines.append(("T s / GJ", lengths, 1.0e3 * reference))
    plot.points.append(("shipped settings", lengths, 1.0e3 * twist))
    run.plots.append(plot)
    return [relative("torsion", float(twist[-1]), float(reference[-1]), 0.10, "rad")]


def buckling(run: Run) -> list[Row]:
    """Load at which the shaft buckles between the base and a guide at its tip.

    The deflection under a small sideways force grows as 1 / (1 - P / P_cr) (Southwell 1932); a line through its
    reciprocals meets zero at the critical load.
    """
    links, shares = 32, np.array([0.0, 0.3, 0.5, 0.7])
    sim, loads = shaft_in_air(run, 2 * len(shares), links)
    stiff, middle = rigidity(sim), links // 2
    length, offset = beam(sim)
    euler = beams.clamped_pinned_load(length, stiff)
    critical, plot = [], Plot("buckling", "axial load / Euler load", "first deflection / deflection")
    for world in range(2 * len(shares)):
        plane, share = divmod(world, len(shares))
        loads.point[world, -1, 2] = offset
        loads.guide[world, -1] = GUIDE
        loads.force[world, -1, 2] = -shares[share] * euler
        loads.force[world, middle, plane] = 0.01
    settle(sim)
    places = sim.endoscope.data.body_pos_w[:, middle].cpu().numpy()
    for plane in range(2):
        rows = slice(plane * len(shares), (plane + 1) * len(shares))
        inverse = 1.0 / places[rows, plane]
        slope, level = np.polyfit(shares * euler, inverse, 1)
        critical.append(float(-level / slope))
        plot.points.append((f"towards {PLANES[plane]}", shares, inverse / inverse[0]))
    plot.lines.append(("1 - P / P_Euler", [0.0, 1.0], [1.0, 0.0]))
    run.plots.append(plot)
    return [worst_plane("buckling", critical, [euler, euler], [0, 1], 0.10, "N")]
