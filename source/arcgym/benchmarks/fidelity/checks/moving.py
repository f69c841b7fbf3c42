# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces between scope and wall while the scope moves."""

from __future__ import annotations

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
    """Push through the bend; compare the means of both forces over each control step.

    Of the second half of the push, when the tip is in the bend: the mean over control steps of the error in a step over
    its force, and the largest error over the mean force. What links have had and not yet given back, the wall gets in
    the next physics step: the note says what is wrong beyond that.
    """
    sim = build(run, PROXIMAL_CFG, BEND, colon={"material": material})
    scope, steps = sim.endoscope, round(CONTROL_STEP / sim.physics_dt)
    still = torch.zeros(1, device=sim.device)
    scope.set_insertion_command(still + SPEED, still)
    on_scope, on_wall, owed = [], [], []
    for _ in range(round((DEPTH - scope.rest_insertion) / (SPEED * CONTROL_STEP))):
        sums = np.zeros((2, 3))
        for _ in range(steps):
            sim.step(1)
            sums[0] += scope.data.link_force_w[0].sum(dim=0).cpu().numpy()
            sums[1] += contact_force_on_wall(sim)
        on_scope.append(sums[0] / steps)
        on_wall.append(sums[1] / steps)
        owed.append(sim.contact.debt.numpy()[0].sum(axis=0, dtype=float) / steps)
    action, reaction = np.linalg.norm(on_scope, axis=1), np.linalg.norm(on_wall, axis=1)
    late = len(action) // 2
    missing = np.array(on_scope) + on_wall
    error = np.linalg.norm(missing, axis=1)[late:]
    beyond = np.linalg.norm(missing[late:] + np.diff(owed, axis=0)[late - 1 :], axis=1)
    share = error / np.maximum(action[late:], LEAST)
    name, time = f"action_reaction_moving_{material}", CONTROL_STEP * np.arange(1, len(action) + 1)
    plot = Plot(name, "time [s]", "force [N]", lines=[("of the wall on the scope", time, action)])
    plot.points.append(("of the scope on the wall", time, reaction))
    run.plots.append(plot)
    mean, sizes = float(action[late:].mean()), (float(reaction[late:].mean()), float(action[late:].mean()))
    note = f"vector sum over {CONTROL_STEP:g} s, mean; at most {share.max():.1%} of a step's force"
    worst = f"largest vector sum over {CONTROL_STEP:g} s, of the mean force; "
    worst += f"beyond what links still owe {beyond.max() / mean:.0e}"
    return [
        Row(name, *sizes, float(share.mean()), 0.02, "N", note),
        Row(f"action_reaction_worst_{material}", *sizes, float(error.max()) / mean, 0.02, "N", worst),
    ]
