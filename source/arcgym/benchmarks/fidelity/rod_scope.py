# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped colonoscope as an elastic rod, pushed into rigid walls of the shape that the simulator has."""

from __future__ import annotations

import numpy as np

from arcgym.assets.endoscope_spec import proximal_spec
from arcgym.benchmarks.fidelity.rod import Rod
from arcgym.benchmarks.fidelity.rod_push import Path, PushSettings, RodPush
from arcgym.benchmarks.fidelity.rod_surface import GridSurface
from arcgym.benchmarks.fidelity.tubes import Tube, wall_measures
from arcgym.sim.simulation_cfg import ContactCfg

SPACING = 0.005
"""Distance of nodes, half of it in the bending section [m]: with twice as many the push through the bend changes by
0.4 %."""
OUTSIDE = 0.06
"""Shaft between the base and the tube at the end of a push [m]: six times the length that the guide bends it over."""
START = 0.03
"""Inserted length at the start of a push [m]."""
ROUND, ALONG = 48, 2.5e-3
"""Points around, and their distance along [m], from which the surface of a tube is interpolated."""


def scope_rod(length: float, spacing: float = SPACING) -> tuple[Rod, np.ndarray]:
    """Return the distal ``length`` [m] of the colonoscope, base first, and its nodes' distances from the wall [m].

    Rigidity and radius are those of the nearest hinge and link; the skin that contact adds to a link is part of the
    distance.
    """
    spec = proximal_spec()
    section = float(spec.link_length[-spec.bending_links :].sum())
    shaft, tip = round((length - section) / spacing), round(2.0 * section / spacing)
    edges = np.r_[np.full(shaft, (length - section) / shaft), np.full(tip, section / tip)]
    before_tip = edges.sum() - np.r_[0.0, np.cumsum(edges)]
    ends = spec.total_length - np.cumsum(spec.link_length)
    hinge = np.abs(before_tip[1:-1, None] - ends[None, :-1]).argmin(axis=1)
    link = np.searchsorted(-ends, -before_tip - 1.0e-9)
    skin = ContactCfg().wall_radius
    return Rod(edges, spec.bending_rigidity[hinge]), spec.link_radius[np.minimum(link, len(ends) - 1)] + skin


def tube_surface(tube: Tube) -> GridSurface:
    """Return the smooth inside of a tube."""
    arc = np.linspace(0.0, tube.length, round(tube.length / ALONG) + 1)
    return GridSurface(tube.surface(arc, 2.0 * np.pi * np.arange(ROUND) / ROUND, wall_measures().radius))


def push_rod(surface: GridSurface, depth: float, friction: float, spacing: float = SPACING) -> Path:
    """Push the colonoscope as a rod until a length is inserted [m]."""
    rod, radius = scope_rod(depth + OUTSIDE, spacing)
    push = RodPush(rod, radius, float(proximal_spec().link_radius[-1]), surface, PushSettings(friction=friction))
    push.place(START)
    return push.push(depth)
