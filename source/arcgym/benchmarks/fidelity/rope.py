# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A limp shaft, pulled around a loop under a dead load on its end."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.loads import LinkLoads
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.placement import follow
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.tubes import Tube, wall_measures
from arcgym.utils.math import quat_apply

LOOP = Tube(0.50, math.pi, 0.10, 0.08)
"""Tube that turns back, for pulling a rope around it."""
LIMP = 1.0e-4
"""Bending rigidity of the rope [N m^2]: a hundredth of the bending section's."""
PULL = 3.0
"""Dead load on the rope's end [N]."""
FRICTION = (0.0, 0.05, 0.1, 0.15, 0.2)
"""Friction coefficients of the worlds."""
SPEED = 0.05
"""Speed at which the tether is withdrawn [m/s]."""
SAMPLE, SAMPLES = 0.05, 20
"""Time over which forces are averaged [s] and number of such times: the tether moves by two links, its period."""
ANGLES = np.linspace(0.1, 0.9, 9) * LOOP.bend
"""Angles from the loaded end at which tensions are compared [rad]."""


def rope(run: Run) -> tuple[Any, LinkLoads]:
    """Return worlds of different friction with a limp shaft around the loop, its end loaded along the tube."""
    limp = {"shaft_rigidity": LIMP, "tip_rigidity": LIMP}
    sim = build(run, PROXIMAL_CFG, LOOP, len(FRICTION), endoscope=limp)
    loads = LinkLoads(sim)
    inserted = LOOP.length - 0.06
    follow(sim, LOOP, inserted)
    sim.endoscope.write_friction_to_sim(torch.tensor(FRICTION, device=sim.device))
    _, angle = LOOP.frame(np.array([LOOP.length]))
    loads.force[:, -1] = PULL * torch.tensor([0.0, math.sin(angle[0]), math.cos(angle[0])], device=sim.device)
    return sim, loads


def surface_lever(sim: Any) -> float:
    """Return the surface's distance from the bend's center over that of the axis, both along the inner side.

    Friction acts on the surface, which turns on a shorter lever than the axis, where the tension is.
    """
    radius = float(sim.endoscope.stage.link_radius[0])
    surface = LOOP.bend_radius - wall_measures().radius
    return surface / (surface + radius)


def pull_rope(sim: Any, loads: LinkLoads, speed: float = 0.05) -> tuple[np.ndarray, np.ndarray]:
    """Withdraw the rope; mean pull on its base [N] and angle it turns by [rad] in each world."""
    data, still = sim.endoscope.data, torch.zeros(sim.num_envs, device=sim.device)
    sim.endoscope.set_insertion_command(still - speed, still)
    sim.step(round(0.6 / sim.physics_dt))
    pulls, angles = [], []
    axis = torch.tensor([0.0, 0.0, 1.0], device=sim.device).expand(*data.body_quat_w.shape[:2], 3)
    for _ in range(12):
        sim.step(round(0.05 / sim.physics_dt))
        pulls.append(-data.base_force.cpu().numpy())
        direction = quat_apply(data.body_quat_w, axis)
        entry = (data.body_pos_w[0, :, 2] - 0.5 * LOOP.bend_start).abs()[: data.body_pos_w.shape[1] // 2 + 20].argmin()
        cosine = (direction[:, entry] * loads.force[:, -1] / PULL).sum(dim=1)
        angles.append(torch.arccos(cosine.clamp(-1.0, 1.0)).cpu().numpy())
    return np.mean(pulls, axis=0), np.mean(angles, axis=0)


def tension_along(run: Run) -> np.ndarray:
    """Return the tension at the angles of the bend, geometric mean over the pull [N], shape (W, A)."""
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
    """Return the tension at the base end of every link: angle to the load [rad], size [N], shape (W, L).

    It is the sum of the load and of what the wall does to the link and to those beyond it.
    """
    load = loads.force[:, -1:]
    tension = load + sim.endoscope.data.link_force_w.flip(1).cumsum(1).flip(1)
    size = torch.linalg.vector_norm(tension, dim=2)
    angle = torch.arccos(((tension * load).sum(dim=2) / (size * PULL)).clamp(-1.0, 1.0))
    return angle.cpu().numpy(), size.cpu().numpy()
