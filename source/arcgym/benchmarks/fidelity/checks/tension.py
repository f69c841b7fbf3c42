# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tension of an inflated wall: a tube of clinical tissue is pressed oval."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.shell import ShellMesh
from arcgym.assets import GasCfg
from arcgym.benchmarks.fidelity.checks.wall import oval
from arcgym.benchmarks.fidelity.loads import load_wall, settle
from arcgym.benchmarks.fidelity.models import build, shaft_spec
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import FREE, Tube
from arcgym.sim.wall.abdomen import vertex_area

TUBE = Tube(0.40)
"""The tube; its rings and sectors are the shipped sigmoid's."""
TRACTION = 20.0
"""Largest of the load on the wall [Pa]; without tension it would give by millimeters."""
MODE = 2
"""Waves of the load around the tube."""


def press_oval(run: Run) -> list[Row]:
    """Press a tube oval that gas holds open, and compare half way along, where its held ends are far, with a ring.

    The note says how far the same wall goes if the tension that bears the gas is left out.
    """
    moved = {}
    for pretension in (True, False):
        gas = GasCfg(enabled=True, leak_conductance=0.0, pretension=pretension)
        colon = {"material": "clinical", "anchor_stiffness": FREE, "gas": gas}
        sim = build(run, shaft_spec(3), TUBE, colon=colon)
        wall = sim.colon.wall
        assert isinstance(wall, ShellMesh)  # by default
        points = wall.points.astype(float)
        angle = np.arctan2(points[:, 1], points[:, 0])
        outwards = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        area = vertex_area(points, wall.triangles) * sim.colon.mobile()
        load_wall(sim, TRACTION * oval(TUBE.length)(angle, points[:, 2]) * area[:, None])
        settle(sim, tolerance=1.0e-7)
        away = ((sim.colon.data.nodal_pos_w[0].cpu().numpy() - points) * outwards).sum(axis=1)
        middle = wall.ring == wall.ring.max() // 2
        moved[pretension] = 2.0 * float((away * np.cos(MODE * angle))[middle].mean())
    radius = float(np.hypot(points[:, 0], points[:, 1])[middle].mean())
    modulus, ratio = sim.colon.elasticity()
    thickness, pressure = sim.colon.thickness, gas.imaging_pressure - gas.abdominal_pressure
    theory = 1.0e3 * ring_move(modulus, ratio, thickness, radius, pressure)
    note = f"without its tension {1.0e3 * moved[False]:.2f} mm; a ring in plane strain"
    return [relative("tension_oval", 1.0e3 * moved[True], theory, 0.10, "mm", note)]


def ring_move(modulus: float, ratio: float, thickness: float, radius: float, pressure: float) -> float:
    """Return how far a ring under pressure moves outwards by a load ``TRACTION`` cos(n t) [m].

    It moves outwards by a cos(n t) and around by b sin(n t). Per pi and length, the energy is half of
    A (a + n b)^2 / R of stretching, D (n^2 a + n b)^2 / R^3 of bending, and p (n^2 (a^2 + b^2) + 2 n a b) of the
    tension p R on all that turns or stretches, less the work of p on the area's second variation.

    Args:
        modulus: Young's modulus [Pa].
        ratio: Poisson's ratio.
        thickness: Of the wall [m].
        radius: Of its middle surface [m].
        pressure: Across the wall [Pa].
    """
    n, stretch = MODE, modulus * thickness / (1.0 - ratio**2)
    bend = stretch * thickness**2 / 12.0
    elastic = stretch / radius * np.array([[1.0, n], [n, n**2]]) + bend / radius**3 * np.array(
        [[n**4, n**3], [n**3, n**2]]
    )
    tense = pressure * np.array([[n**2, n], [n, n**2]])
    return float(np.linalg.solve(elastic + tense, [TRACTION * radius, 0.0])[0])
