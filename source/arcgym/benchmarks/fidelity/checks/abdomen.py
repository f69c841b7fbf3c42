# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A stiff tube that its weight, or a hand, presses on the inside of the abdomen, against cylinders on springs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import torch

from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import SEGMENT, Tube, tube_stage

LENGTH = 0.25
"""Length of the tube [m]; nothing holds its ends."""
STIFF = 2.0e8
"""Young's modulus with which it moves as a whole [Pa]."""
GAP = 0.001
"""Way from the tube to the inside of the abdomen [m], a plane: so is the front of a box, by the exponent."""
HELD = {"weight": 1.0e3, "hand": 2.0e4}
"""Stiffness of the tube's attachments per length [N/m^2]: it moves by millimeters, and stays clear of what is in it."""
DENSITY = 1.0e4
"""Mass density of the tube [kg/m^3], with which it weighs 22 N/m."""
FORCE = 30.0
"""Force of the hand [N]."""


def stop(run: Run) -> list[Row]:
    """Measure how deep a tube of known weight goes into the front of the abdomen."""
    from arcgym.sim import WeightCfg

    weight = WeightCfg(enabled=True, posture="prone", imaged="weightless", contents_per_length=0.0)
    sim = tube_in_front(run, HELD["weight"], weight=weight)
    settle(sim)
    load = weight.acceleration * float(sim.wall.nodes.mass.numpy().sum())
    held, reaction = attachment(sim), bearing(sim)
    exact = root(lambda depth: held * (GAP + depth) + reaction(depth) * LENGTH - load)
    return [relative("abdomen_stop", moved(sim) - GAP, exact, 0.05, "m")]


def hand(run: Run) -> list[Row]:
    """Measure how deep a hand presses the front in over a tube, and how hard it presses the tube."""
    sim = tube_in_front(run, HELD["hand"])
    sim.colon.set_hand_pressure(torch.tensor([FORCE], device=sim.device))
    settle(sim)
    stiffness, held, reaction = sim.colon.cfg.abdomen.hand_stiffness, attachment(sim), bearing(sim)

    def dent(depth: float) -> float:
        """Return the dent at which the front is so deep in the tube, which its attachments hold as hard."""
        return depth + GAP + reaction(depth) * LENGTH / held

    depth = root(lambda depth: stiffness * dent(depth) + reaction(depth) * LENGTH - FORCE)
    return [
        relative("hand_dent", float(sim.colon.data.hand_dent[0]), dent(depth), 0.03, "m"),
        relative("hand_push", -held * moved(sim), reaction(depth) * LENGTH, 0.05, "N"),
    ]


def tube_in_front(run: Run, held: float, **changes: Any) -> Any:
    """Return a stiff tube, free but for its attachments [N/m^2], behind a plane front."""
    from arcgym.assets import AbdomenCfg

    abdomen = AbdomenCfg(
        enabled=True, squareness=10.0, hand_radius=0.3, hand_place=(0.0, 0.0), hand_time=0.05, hand_depth=0.2
    )
    sim = free_tube(run, {"anchor_stiffness": {SEGMENT: held}, "abdomen": abdomen}, **changes)
    front = float(sim.colon.data.nodal_pos_w[..., 1].max()) + GAP
    shape = sim.surroundings.abdomen.shape
    shape.tight.assign(np.array([[1.0, 0.1, 1.0]], np.float32))
    shape.center.assign(np.array([[0.0, front - 0.1, 0.5 * LENGTH]], np.float32))
    shape.gap.zero_()
    return sim


def free_tube(run: Run, colon: dict[str, Any], **changes: Any) -> Any:
    """Return a stiff, heavy tube whose ends nothing holds.

    Args:
        run: Device and folder.
        colon: Changes of ``ColonCfg``.
        changes: Changes of ``SimulationCfg``.
    """
    from arcgym.anatomy import ANCHOR_FREE, write_colon
    from arcgym.assets import CAPSULE_CFG, ColonCfg
    from arcgym.assets.colon import Colon
    from arcgym.assets.endoscope import Endoscope
    from arcgym.sim import Simulation, SimulationCfg

    stage = tube_stage(Tube(LENGTH, refine=2))
    path = run.folder / "free_tube" / "colon.usda"
    if not path.exists():
        free = np.full(len(stage.wall.points), ANCHOR_FREE, np.int32)
        write_colon(replace(stage, wall=replace(stage.wall, anchor=free)), path)
    cfg = ColonCfg(usd_path=str(path), youngs_modulus=STIFF, density=DENSITY, **colon)
    return Simulation(SimulationCfg(device=run.device, **changes), Colon(cfg), Endoscope(CAPSULE_CFG), 1)


def moved(sim: Any) -> float:
    """Return how far the tube has moved to the front, the mean of its middle third [m]."""
    third = np.abs(sim.colon.wall.ring_arc[sim.colon.wall.ring] - 0.5 * LENGTH) < LENGTH / 6.0
    moved = (sim.colon.data.nodal_pos_w - sim.colon.data.default_nodal_pos_w)[0, torch.tensor(third), 1]
    return float(moved.mean())


def attachment(sim: Any) -> float:
    """Return the stiffness of the tube's attachments altogether [N/m]: rings at the ends stand for whole spacings."""
    return sim.colon.cfg.anchor_stiffness[SEGMENT] * float(np.gradient(sim.colon.wall.ring_arc).sum())


def bearing(sim: Any) -> Any:
    """Return the function from depth [m] to load per length [N/m] of a cylinder on springs of the abdomen's stiffness.

    Sum of k (h - R (1 - cos a)) R da over the angles a where it is deep, -b to b with cos b = 1 - h / R:
    2 k R ((h - R) b + R sin b).
    """
    stiffness = sim.colon.cfg.abdomen.stiffness
    points = sim.colon.data.default_nodal_pos_w[0].cpu().numpy()
    radius = float(np.linalg.norm(points[:, :2], axis=1).mean())

    def load(depth: float) -> float:
        angle = math.acos(1.0 - max(depth, 0.0) / radius)
        return 2.0 * stiffness * radius * ((depth - radius) * angle + radius * math.sin(angle))

    return load


def root(function: Any) -> float:
    """Return the depth between 0 and 15 mm at which an ascending function is zero [m]."""
    from scipy.optimize import brentq

    return float(brentq(function, 1.0e-9, 0.015))
