# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The wall's stiffness, on the shipped mesh, against a tube of quadratic bricks.

A straight tube with the sigmoid's radius, thickness, rings and sectors is held at its ends as the colon is, and loaded
with dead forces on its lumen side. The answer is the displacement weighted by the load, which needs no place to be
picked on two different meshes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.loads import load_wall, settle
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.benchmarks.fidelity.tube_model import Traction, TubeModel
from arcgym.benchmarks.fidelity.tubes import FREE, Tube, wall_measures

FORCE = 2.0
"""Sizes of the dead forces on the wall, added up [N]: strains stay small."""
PATCH = 0.6
"""Half angle of a pinched patch, where the load falls to 1/e [rad]."""
BEAM_MESH = {"around": 16, "along": 48}
"""Bricks of the reference under a load across: twice as many along are 1 % softer, more around the same."""
RING_MESH = {"around": 32, "along": 24}
"""Bricks of the pinched reference: 24 around are 2 % stiffer, 32 along the same to 0.1 %."""
HELD_RINGS = (2, -2)
"""Rings of a colon between which its wall is free."""


def free_span(sim: Any) -> tuple[float, float]:
    """Return the arc lengths between which the wall is free [m]."""
    arc = sim.colon.wall.ring_arc
    return float(arc[HELD_RINGS[0]]), float(arc[HELD_RINGS[1]])


def reference_tube(sim: Any, **mesh: int) -> TubeModel:
    """Return bricks with the measures and the tissue of a simulation's straight tube."""
    start, end = free_span(sim)
    measures = wall_measures()
    return TubeModel(end - start, measures.radius, measures.thickness, *sim.colon.elasticity(), **mesh)


def along(z: np.ndarray, length: float) -> np.ndarray:
    """Share of a load at a distance from the tube's held end: a bump one ring wide, half way."""
    return np.exp(-(((z - 0.5 * length) / wall_measures().spacing) ** 2))


def pinch(length: float) -> Traction:
    """Return the load that pulls two opposite patches apart along X."""

    def traction(angle: np.ndarray, z: np.ndarray) -> np.ndarray:
        towards = [np.exp(-((wrapped(angle - side) / PATCH) ** 2)) for side in (0.0, np.pi)]
        return (along(z, length) * (towards[0] - towards[1]))[:, None] * np.array([1.0, 0.0, 0.0])

    return traction


def transverse(length: float) -> Traction:
    """Return the load that pulls the rings half way along X as a whole."""
    return lambda angle, z: along(z, length)[:, None] * np.array([1.0, 0.0, 0.0])


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Return the angle between -pi and pi."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def shipped_displacements(sim: Any, traction: Traction) -> tuple[np.ndarray, np.ndarray]:
    """Load on each vertex of the shipped wall, one newton in all, and its displacement [m/N], both of shape (V, 3)."""
    wall, rest = sim.colon.wall, sim.colon.data.nodal_pos_w[0].clone()
    points = wall.points.astype(float)
    load = traction(np.arctan2(points[:, 1], points[:, 0]), points[:, 2] - free_span(sim)[0])
    load *= ((wall.layer == 0) & sim.colon.mobile())[:, None]
    load /= np.linalg.norm(load, axis=1).sum()
    load_wall(sim, FORCE * load)
    settle(sim, tolerance=5.0e-7)
    moved = (sim.colon.data.nodal_pos_w[0] - rest).cpu().numpy()
    return load, moved / FORCE


def seam(points: np.ndarray) -> np.ndarray:
    """Return the points on the line that the load pulls along X, by ascending Z: angle zero, innermost."""
    angle, radius = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
    line = np.flatnonzero((np.abs(angle) < 1.0e-6) & (radius < radius.min() + 1.0e-5))
    return line[np.argsort(points[line, 2])]


def beam_mode(run: Run) -> list[Row]:
    """Measure a tube held at its ends under a load across it."""
    return [stiffness_row(run, "wall_beam", Tube(0.45), transverse, BEAM_MESH, 0.10)]


def ring_mode(run: Run) -> list[Row]:
    """Measure a tube pinched half way."""
    return [stiffness_row(run, "wall_ring", Tube(0.20), pinch, RING_MESH, 0.20)]


def stiffness_row(run: Run, name: str, tube: Tube, load: Any, mesh: dict[str, int], bound: float) -> Row:
    """Measure the stiffness of the shipped wall against the reference's."""
    from arcgym.assets import CAPSULE_CFG

    sim = build(run, CAPSULE_CFG, tube, colon={"anchor_stiffness": FREE})
    start, end = free_span(sim)
    traction = load(end - start)
    force, moved = shipped_displacements(sim, traction)
    ours, tube_model = float((force * moved).sum()), reference_tube(sim, **mesh)
    nodes, limit = tube_model.points(), tube_model.displacements(traction)
    exact = tube_model.compliance(traction, limit)
    plot = Plot(name, "place along the tube [m]", "displacement of the pulled line [mm/N]")
    points = sim.colon.wall.points.astype(float)
    line, own = seam(nodes), seam(points)
    plot.lines.append(("27-node bricks", start + nodes[line, 2], 1.0e3 * limit[line, 0]))
    plot.points.append(("shipped settings", points[own, 2], 1.0e3 * moved[own, 0]))
    run.plots.append(plot)
    return relative(name, 1.0 / ours, 1.0 / exact, bound, "N/m", f"{exact / ours:.2f} times the reference")
