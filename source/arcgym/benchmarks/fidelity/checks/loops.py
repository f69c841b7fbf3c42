# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two limbs of a hairpin that rub on each other, held by springs that measure it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
import warp as wp

from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import SEGMENT, Tube

LIMB, TURN = 0.12, 0.022
"""Length of each limb, and radius of the turn [m]."""
TUBE = Tube(2.0 * LIMB + math.pi * TURN, bend=math.pi, bend_start=LIMB, bend_radius=TURN)
"""The hairpin, its limbs side by side."""
SOFT = 1.0e3
"""Young's modulus [Pa]: the wall passes on next to nothing, the springs hold every vertex."""
HELD = 4.0e4
"""Stiffness of the springs per length [N/m^2]."""
TOGETHER, SPEED, TIME = 0.006, 0.01, 1.5
"""Way by which each limb is drawn to the other [m], speed [m/s] and duration [s] of the slide."""
MIDDLE = (0.07, 0.025)
"""Middle of the stretch of the first limb whose springs are read, and half its length [m]: away from held end and turn,
where all rings are alike, the wall passes on nothing."""
FRICTION = 0.3
"""Coulomb coefficient."""


def slide(run: Run) -> list[Row]:
    """Draw the limbs together, slide one along the other, and compare what the springs pull with Coulomb's law.

    A second world without friction has all else that drags: the difference of the pulls along over the pull across.
    """
    from arcgym.assets import CAPSULE_CFG
    from arcgym.sim import LoopFrictionCfg

    colon = {"youngs_modulus": SOFT, "anchor_stiffness": {SEGMENT: HELD}}
    loops = LoopFrictionCfg(enabled=True, friction=FRICTION)
    sim = build(run, CAPSULE_CFG, TUBE, num_envs=2, colon=colon, loops=loops)
    sim.write_loop_friction(torch.zeros(1, device=sim.device), env_ids=[1])
    arc = sim.colon.wall.ring_arc[sim.colon.wall.ring]
    lower, upper = (torch.tensor(where, device=sim.device) for where in (arc < LIMB, arc > TUBE.length - LIMB))
    rest = wp.to_torch(sim.wall.nodes.anchors.rest)[:, 0]
    rest[lower, 1] += TOGETHER
    rest[upper, 1] -= TOGETHER
    sim.step(480)
    for _ in range(round(TIME / (4 * sim.physics_dt))):
        rest[lower, 2] += SPEED * 4 * sim.physics_dt
        sim.step(4)
    pull = pulls(sim, np.abs(arc - MIDDLE[0]) < MIDDLE[1])
    drag, push = abs(float(pull[0, 2] - pull[1, 2])), abs(float(pull[:, 1].mean()))
    return [relative("loop_friction", drag / push, FRICTION, 0.1, note=f"pressed by {push:.2f} N")]


def pulls(sim: Any, which: np.ndarray) -> np.ndarray:
    """Return the pull of the springs on some vertices [N], shape (N, 3)."""
    anchors = sim.wall.nodes.anchors
    stretch = anchors.rest.numpy()[:, :1] - sim.nodal_pos.numpy()
    return (anchors.stiffness.numpy()[:, :1, None] * stretch)[which].sum(axis=0)
