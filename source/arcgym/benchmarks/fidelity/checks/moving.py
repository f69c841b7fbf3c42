# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces between scope and wall while the scope moves."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.checks.balance import contact_force_on_wall
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.pushes import BEND, CONTROL_STEP, DEPTH, SPEED
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run

LEAST = 0.2
"""Force below which errors are compared with it [N]."""


def action_reaction(run: Run, material: str) -> list[Row]:
    """Push through the bend; compare the means of both forces over 0.1 s, in the second half, with the tip in the bend.

    ``moving``: the mean over control steps of the error in a step over its force, both forces at the same instants.
    ``worst``: the largest error over the mean force in any 0.1 s, with what the wall gets a step late counted with the
    step that it is for. The same instants differ by what links owe at both ends of the 0.1 s, wherever these are: that
    tells nothing of what is lost. The note has it, too.
    """
    sim = build(run, PROXIMAL_CFG, BEND, colon={"material": material})
    steps = round(CONTROL_STEP / sim.physics_dt)
    count = steps * round((DEPTH - sim.endoscope.rest_insertion) / (SPEED * CONTROL_STEP))
    on_scope, on_wall, late = forces_while_pushing(sim, count + 1)
    handed = on_wall - late
    handed[:-1] += late[1:]
    action, reaction = (
        np.linalg.norm(one[:count].reshape(-1, steps, 3).mean(axis=1), axis=1) for one in (on_scope, on_wall)
    )
    half = len(action) // 2
    missing = (on_scope + on_wall)[:count].reshape(-1, steps, 3).mean(axis=1)
    share = np.linalg.norm(missing, axis=1)[half:] / np.maximum(action[half:], LEAST)
    name, time = f"action_reaction_moving_{material}", CONTROL_STEP * np.arange(1, len(action) + 1)
    plot = Plot(name, "time [s]", "force [N]", lines=[("of the wall on the scope", time, action)])
    plot.points.append(("of the scope on the wall", time, reaction))
    run.plots.append(plot)
    mean, sizes = float(action[half:].mean()), (float(reaction[half:].mean()), float(action[half:].mean()))
    note = f"vector sum over {CONTROL_STEP:g} s, mean; at most {share.max():.1%} of a step's force"
    lost, apart = (largest_mean((on_scope + one)[half * steps : count], steps) / mean for one in (handed, on_wall))
    worst = f"largest vector sum over any {CONTROL_STEP:g} s, of the mean force, what is paid a step late counted with "
    worst += f"its step; {apart:.1%} at the same instants"
    return [
        Row(name, *sizes, float(share.mean()), 0.02, "N", note),
        Row(f"action_reaction_worst_{material}", *sizes, lost, 0.02, "N", worst),
    ]


def forces_while_pushing(sim: Any, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Push for ``count`` physics steps.

    Returns:
        Force of each step on the scope, on the wall, and how much of the latter links owed from the step before [N],
        shape (count, 3) each.
    """
    still = torch.zeros(1, device=sim.device)
    sim.endoscope.set_insertion_command(still + SPEED, still)
    forces = np.zeros((3, count, 3))
    for k in range(count):
        sim.step(1)
        forces[0, k] = sim.endoscope.data.link_force_w[0].sum(dim=0).cpu().numpy()
        forces[1, k] = contact_force_on_wall(sim)
        records = sim.contact.records
        forces[2, k] = records.owed.numpy()[: records.start.numpy()[0, -1]].sum(axis=0, dtype=float)
    return forces[0], forces[1], forces[2]


def largest_mean(force: np.ndarray, steps: int) -> float:
    """Return the largest length of the mean of ``force``, shape (T, 3), over any ``steps`` one after the other [N]."""
    sums = np.cumsum(np.vstack([np.zeros((1, 3)), force]), axis=0)
    return float(np.linalg.norm(sums[steps:] - sums[:-steps], axis=1).max()) / steps
