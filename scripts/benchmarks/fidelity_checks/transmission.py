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


@check("bend_loss")
def bend_loss(run: Run) -> list[Row]:
    """Tension along a tether around the bend; the row is the share of ln T that a line over the angle explains.

    The published shape of the loss is exponential in contact angle times friction (Huan et al. 2020, of the tether of a
    magnetic colonoscope), a straight line of ln T over the angle.
    """
    angle, tension = tension_along(run)
    plot = Plot("bend_loss", "contact angle × friction coefficient", "tension / load")
    shapes, rates = [], []
    for k, friction in enumerate(FRICTION):
        inside = (angle[k] > 0.05 * LOOP.bend) & (angle[k] < 0.95 * LOOP.bend)
        x, y = angle[k][inside], np.log(tension[k][inside] / PULL)
        slope, level = np.polyfit(x, y, 1)
        rates.append(slope / friction if friction else 0.0)
        shapes.append(1.0 - float(np.var(y - slope * x - level) / np.var(y)) if friction else 1.0)
        if friction:
            plot.points.append((f"μ = {friction:g}", friction * x, tension[k][inside] / PULL))
    reach = np.linspace(0.0, max(FRICTION) * LOOP.bend, 50)
    plot.lines.append(("exp(μθ)", reach, np.exp(reach)))
    run.plots.append(plot)
    shipped = FRICTION.index(0.1)
    note = "growth over μ: " + ", ".join(f"{r:.2f} at {f:g}" for f, r in zip(FRICTION, rates, strict=True) if f)
    return [absolute("bend_loss", shapes[shipped], 1.0, 0.01, "", note)]


def tension_along(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Angle from the loaded end [rad] and tension [N] at every link, means over the pull, shape (W, L)."""
    import torch

    sim, loads = rope(run)
    still = torch.zeros(sim.num_envs, device=sim.device)
    sim.endoscope.set_insertion_command(still - SPEED, still)
    sim.step(round(0.6 / sim.physics_dt))
    angles, tensions = [], []
    for _ in range(12):
        sim.step(round(0.05 / sim.physics_dt))
        angle, tension = link_tensions(sim, loads)
        angles.append(angle)
        tensions.append(tension)
    return np.mean(angles, axis=0), np.mean(tensions, axis=0)


def link_tensions(sim: Any, loads: Any) -> tuple[np.ndarray, np.ndarray]:
    """Angle of each link to the load [rad], and pull in it [N]: the load and what the wall does to the links beyond."""
    import torch

    from arcgym.utils.math import quat_apply

    data = sim.endoscope.data
    axis = torch.tensor([0.0, 0.0, 1.0], device=sim.device).expand(*data.body_quat_w.shape[:2], 3)
    direction = quat_apply(data.body_quat_w, axis)
    load = loads.force[:, -1:]
    wall = data.wall_force_w
    beyond = wall.flip(1).cumsum(1).flip(1) - 0.5 * wall
    tension = ((load + beyond) * direction).sum(dim=2)
    angle = torch.arccos((direction * load).sum(dim=2).div(PULL).clamp(-1.0, 1.0))
    return angle.cpu().numpy(), tension.cpu().numpy()
