# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How a bend with friction eats the pull on a tether: exponentially in contact angle times friction."""

from __future__ import annotations

from typing import Any

import numpy as np

from fidelity_checks.contact import FRICTION, LOOP, PULL, rope
from fidelity_checks.table import Plot, Row, Run, absolute, check

SPEED = 0.05
"""Speed at which the tether is withdrawn [m/s]."""
SAMPLE, SAMPLES = 0.05, 20
"""Time over which forces are averaged [s] and number of such times: the tether moves by two links, its period."""
ANGLES = np.linspace(0.1, 0.9, 9) * LOOP.bend
"""Angles from the loaded end at which tensions are compared [rad]."""


@check("bend_loss", quick=True)
def bend_loss(run: Run) -> list[Row]:
    """Tension along a tether around the bend; the row is the share of ln T that a line over the angle explains.

    The published shape of the loss is exponential in contact angle times friction (Huan et al. 2020, of the tether of a
    magnetic colonoscope), a straight line of ln T over the angle.
    """
    gain = np.log(tension_along(run))
    gain -= gain[FRICTION.index(0.0)]
    plot = Plot("bend_loss", "contact angle × friction coefficient", "tension / tension without friction")
    shapes, rates = {}, {}
    for friction, y in zip(FRICTION, gain, strict=True):
        if friction > 0.0:
            slope, level = np.polyfit(ANGLES, y, 1)
            rates[friction] = slope / friction
            shapes[friction] = 1.0 - float(np.var(y - slope * ANGLES - level) / np.var(y))
            plot.points.append((f"μ = {friction:g}", friction * ANGLES, np.exp(y)))
    reach = np.linspace(0.0, max(FRICTION) * LOOP.bend, 50)
    plot.lines.append(("exp(μθ)", reach, np.exp(reach)))
    run.plots.append(plot)
    note = "growth over μ: " + ", ".join(f"{rate:.2f} at {friction:g}" for friction, rate in rates.items())
    return [absolute("bend_loss", shapes[0.1], 1.0, 0.01, "", note)]


def tension_along(run: Run) -> np.ndarray:
    """Tension at the angles of the bend, geometric mean over the pull [N], shape (W, A)."""
    import torch

    sim, loads = rope(run)
    still = torch.zeros(sim.num_envs, device=sim.device)
    sim.endoscope.set_insertion_command(still - SPEED, still)
    sim.step(round(0.6 / sim.physics_dt))
    total = np.zeros((sim.num_envs, len(ANGLES)))
    for _ in range(SAMPLES):
        sim.step(round(SAMPLE / sim.physics_dt))
        for world, (angle, tension) in enumerate(zip(*link_tensions(sim, loads), strict=True)):
            order = np.argsort(angle)
            total[world] += np.interp(ANGLES, angle[order], np.log(tension[order])) / SAMPLES
    return np.exp(total)


def link_tensions(sim: Any, loads: Any) -> tuple[np.ndarray, np.ndarray]:
    """Tension at the base end of every link: angle to the load [rad] and size [N], shape (W, L).

    It is the sum of the load and of what the wall does to the link and to those beyond it.
    """
    import torch

    load = loads.force[:, -1:]
    tension = load + sim.endoscope.data.wall_force_w.flip(1).cumsum(1).flip(1)
    size = torch.linalg.vector_norm(tension, dim=2)
    angle = torch.arccos(((tension * load).sum(dim=2) / (size * PULL)).clamp(-1.0, 1.0))
    return angle.cpu().numpy(), size.cpu().numpy()
