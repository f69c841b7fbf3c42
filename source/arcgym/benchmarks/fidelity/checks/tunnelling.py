# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A wall that lets no link through."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.loads import LinkLoads
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.placement import follow
from arcgym.benchmarks.fidelity.pushes import BEND, DEPTH
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute
from arcgym.benchmarks.lumen import LumenCheck
from arcgym.utils.math import quat_apply

SHOVE = 20.0
"""Force on a link [N]."""
SHOVED = 16
"""Links that are shoved, from the tip backwards: those beyond the held end of the tube."""
SIDES = ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
"""Directions of the force, in the link's frame."""


def tunnelling(run: Run) -> list[Row]:
    """Count links outside the lumen while 20 N push one of them against the softest preset, for two seconds.

    The worlds differ in the link pushed, from the tip backwards, and in the side: to either side of the bend's plane,
    out of the bend and into it; the tip is pushed forwards and backwards, too. Links of a world that is not finite
    count as outside.
    """
    shoves = [(-1 - link, side) for link in range(SHOVED) for side in SIDES]
    shoves += [(-1, (0.0, 0.0, along)) for along in (1.0, -1.0)]
    sim = build(run, PROXIMAL_CFG, BEND, len(shoves), {"material": "in_situ"})
    loads = LinkLoads(sim)
    follow(sim, BEND, DEPTH)
    sim.step(24)
    for world, (link, side) in enumerate(shoves):
        quat = sim.endoscope.data.body_quat_w[world, link]
        loads.force[world, link] = SHOVE * quat_apply(quat, torch.tensor(side, device=sim.device))
    lumen, events, moved, times = LumenCheck(sim), np.zeros(sim.num_envs), [], []
    for _ in range(20):
        sim.step(24)
        events += links_outside(sim, lumen)
        moved.append(sim.colon.data.nodal_displacement.nan_to_num(0.0).amax(dim=1).cpu().numpy())
        times.append(24 * len(moved) * sim.physics_dt)
    deepest, displacement = float(np.max(moved)), 1.0e3 * np.array(moved)
    plot = Plot("tunnelling", "time [s]", "largest displacement of the wall [mm]")
    names = ("+X", "-X", "+Y", "-Y")
    plot.points += [(f"tip to {name}", times, displacement[:, k]) for k, name in enumerate(names)]
    plot.lines.append(("any link, largest", times, displacement.max(axis=1)))
    run.plots.append(plot)
    note = f"in {np.count_nonzero(events)} of {sim.num_envs} worlds, {int(sim.non_finite.sum())} not finite; "
    note += f"the wall moved by up to {1e3 * deepest:.0f} mm"
    return [absolute("tunnelling", float(events.sum()), 0.0, 0.0, "", note)]


def links_outside(sim: Any, lumen: LumenCheck) -> np.ndarray:
    """Return the links outside the lumen in each world, shape (W,); all those of a world that is not finite."""
    outside, _ = lumen.outside()
    return torch.where(sim.non_finite, sim.endoscope.num_bodies, outside.sum(dim=1)).cpu().numpy()
