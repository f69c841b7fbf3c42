# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Friction that holds the shaft after a push has stopped."""

from __future__ import annotations

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.pushes import BEND, CONTROL_STEP, DEPTH, SPEED
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative

FRICTION = {"low": 0.1, "high": 0.3}
"""Friction coefficients."""
SLOW = 0.005
"""Speed of the last part of the push [m/s]: damping is then small against friction."""
SLOW_TIME = 2.0
"""Duration of that part [s]."""
HOLD_TIME = 10.0
"""Time without commands after the stop [s]."""


def friction_hold(run: Run) -> list[Row]:
    """Push through the bend, at last slowly, and stop.

    Coulomb friction holds after the stop what it bore before: ``friction_stop_*`` compares the push on the base in the
    first control step of rest with the last of the slow push, ``friction_hold_*`` all those of ten seconds with that
    first one; the row is the step that differs most.
    """
    sim = build(run, PROXIMAL_CFG, BEND, len(FRICTION))
    sim.friction[:] = torch.tensor(list(FRICTION.values()), device=sim.device)
    scope, steps = sim.endoscope, round(CONTROL_STEP / sim.physics_dt)
    still = torch.zeros(sim.num_envs, device=sim.device)
    fast = (DEPTH - scope.rest_insertion - SLOW * SLOW_TIME) / SPEED
    force = []
    for speed, duration in ((SPEED, fast), (SLOW, SLOW_TIME), (0.0, HOLD_TIME)):
        scope.set_insertion_command(still + speed, still)
        for _ in range(round(duration / CONTROL_STEP)):
            sim.step(steps)
            force.append(scope.data.base_force.cpu().numpy().copy())
    held = round(HOLD_TIME / CONTROL_STEP)
    rows, time = [], CONTROL_STEP * (np.arange(len(force)) - len(force) + held + 1)
    plot = Plot("friction_hold", "time after the stop [s]", "push on the base [N]")
    for world, (name, friction) in enumerate(FRICTION.items()):
        push = np.array(force)[:, world]
        plot.points.append((f"μ = {friction:g}", time, push))
        before, after = float(push[-held - 1]), push[-held:]
        worst = float(after[np.argmax(np.abs(after - after[0]))])
        note = f"{after[held // 2]:.2f} N after {HOLD_TIME / 2:g} s, {after[-1]:.2f} N at the end"
        rows.append(relative(f"friction_stop_{name}", float(after[0]), before, 0.05, "N"))
        rows.append(relative(f"friction_hold_{name}", worst, float(after[0]), 0.05, "N", note))
    run.plots.append(plot)
    return rows
