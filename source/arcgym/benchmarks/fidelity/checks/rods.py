# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushes of the colonoscope against another discretization: an elastic rod in equilibrium at every half millimeter.

The walls are rigid on both sides, and of the same shape. The rod has the colonoscope's EI, radii and friction, and
neither links nor speed, damping or facets.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.pushes import BEND, DEPTH, SIGMOID_MOBILE, Trace, push
from arcgym.benchmarks.fidelity.rod_push import Path
from arcgym.benchmarks.fidelity.rod_scope import push_rod, tube_surface
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute, relative
from arcgym.benchmarks.fidelity.smooth_colon import layer_surface
from arcgym.sim.simulation_cfg import ContactCfg

REFINE = 4
"""Rings and sectors of the sigmoid's wall for each one of the shipped: with facets so small, the rod's smooth surface
and ours are the same."""
ROD_DEPTH = 0.30
"""Inserted length at the end of the push into the sigmoid [m]. Until 0.31 m the rod with a quarter of its drag has its
tip within 0.21 mm; then the tip, which nobody steers, jams in a pocket at 14 to 26 N, and it finds no equilibrium."""
ROOM: dict[str, Any] = {"capacity": 40, "patch_capacity": 160}
"""Contacts of sixteen times as many faces."""


def bend(run: Run) -> list[Row]:
    """Push through the rigid bend of 100 degrees."""
    ours = push(run, BEND, DEPTH, rigid=True)
    return compare(run, "bend_rod", ours, push_rod(tube_surface(BEND), DEPTH, ContactCfg().friction))


def sigmoid(run: Run) -> list[Row]:
    """Push into the S of the shipped colon's sigmoid, held rigid; both touch the same smooth surface."""
    ours = push(run, None, ROD_DEPTH, rigid=True, refine=REFINE, contact=ContactCfg(**ROOM))
    facets = push(run, None, ROD_DEPTH, rigid=True)
    limit = push_rod(layer_surface(0, SIGMOID_MOBILE), ROD_DEPTH, ContactCfg().friction)
    force, tip = compare(run, "sigmoid_rod", ours, limit)
    shipped = facets.late(facets.force) / force.reference - 1.0
    return [replace(force, note=f"{force.note}; with the facets of the shipped wall {shipped:+.1%}"), tip]


def compare(run: Run, name: str, ours: Trace, rod: Path) -> list[Row]:
    """Compare the mean push of the second half and the largest distance of the tips in it, at equal insertion."""
    force, tip = sampled(rod, np.array(ours.inserted))
    apart = np.linalg.norm(np.array(ours.tip) - tip, axis=1)
    late = apart[len(apart) // 2 :]
    plot = Plot(f"{name}_force", "inserted length [m]", "push on the base [N]")
    plot.lines.append(("elastic rod", rod.inserted, rod.force))
    plot.points.append(("shipped settings", ours.inserted, ours.force))
    run.plots.append(plot)
    note = f"largest push {max(ours.force):.2f} N, the rod's {force.max():.2f} N"
    return [
        relative(f"{name}_force", ours.late(ours.force), ours.late(list(force)), 0.10, "N", note),
        absolute(f"{name}_tip", float(late.max()), 0.0, 0.002, "m", f"largest; {1e3 * late.mean():.2f} mm on average"),
    ]


def sampled(rod: Path, inserted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rod's push, mean since the sample before [N], and its tip [m], at inserted lengths [m]."""
    steps = np.linspace(0.0, 1.0, 10, endpoint=False)
    before = np.r_[2.0 * inserted[0] - inserted[1], inserted[:-1]]
    windows = inserted[:, None] - steps * (inserted - before)[:, None]
    force = np.interp(windows, rod.inserted, rod.force).mean(axis=1)
    tip = np.stack([np.interp(inserted, rod.inserted, column) for column in np.array(rod.tip).T], axis=1)
    return force, tip
