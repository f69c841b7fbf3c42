# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A hairpin of 12 mm radius for tests, its limbs 40 mm from axis to axis, and two tubes side by side."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
import warp as wp
from tiny import tiny_colon_stage
from tiny_sim import TinySim

from arcgym.anatomy import write_colon
from arcgym.sim import Simulation

LIMB, WIDTH, RADIUS = 0.09, 0.04, 0.012
"""Length of each limb, their distance and the radius of the lumen [m]."""
COLON = {
    "youngs_modulus": 1.0e5,
    "anchor_stiffness": dict.fromkeys(("rectum", "sigmoid", "descending", "splenic", "transverse"), 4.0e3),
}
"""Soft, and held with 4000 N/m^2: by 50 N/m for each ring of 12 mm."""
LOWER, UPPER = (4, 5, 6), (14, 15, 16)
"""Rings of the two limbs, of 21; rings 7 to 13 make the turn."""


class HairpinSim(TinySim):
    """Simulations in a tube that runs up along Z, turns towards +Y and comes down again."""

    def __init__(self, folder: Path, width: float = WIDTH) -> None:
        """``width`` is the distance of the limbs [m]."""
        self.folder = folder
        stage = tiny_colon_stage(
            length=2.0 * LIMB + 0.5 * math.pi * width, radius=RADIUS, rings=21, texture_folder=folder
        )
        wall = replace(stage.wall, points=hairpin(stage.wall.points, width))
        self.colon_path = write_colon(replace(stage, wall=wall), folder / "colon.usda")


def hairpin(points: np.ndarray, width: float = WIDTH) -> np.ndarray:
    """Bend points beside the Z axis, shape (V, 3), to limbs ``width`` [m] apart."""
    x, y, s = points.T
    turn = np.clip((s - LIMB) / (0.5 * width), 0.0, math.pi)
    ahead = np.minimum(s - LIMB, 0.0) + np.maximum(s - LIMB - 0.5 * math.pi * width, 0.0)
    across = 0.5 * width * (1.0 - np.cos(turn)) + y * np.cos(turn)
    along = LIMB + 0.5 * width * np.sin(turn) - y * np.sin(turn) + ahead * np.cos(turn)
    return np.stack([x, across, along], axis=1).astype(np.float32)


def of_rings(sim: Simulation, rings: tuple[int, ...]) -> torch.Tensor:
    return torch.from_numpy(np.isin(sim.colon.wall.ring, rings))


def step_wall(sim: Simulation, steps: int) -> None:
    """Advance the wall without a scope in it."""
    for _ in range(steps):
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)


def draw_together(sim: Simulation, way: float) -> None:
    """Move the places that the limbs' anchors pull to by ``way`` [m] towards each other."""
    rest = wp.to_torch(sim.wall.nodes.anchors.rest)[:, 0]
    rest[of_rings(sim, LOWER), 1] += way
    rest[of_rings(sim, UPPER), 1] -= way


def two_tubes(distance: float, spacing: float = 0.0125) -> tuple[np.ndarray, np.ndarray]:
    """Return points and rings of a tube of 20 mm radius up and one down beside it, 8 rings of 12 vertices each."""
    angle = np.arange(12) * np.pi / 6.0
    ring = 0.02 * np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    centers = [[side * distance, 0.0, z] for side, way in ((0, 1), (1, -1)) for z in spacing * np.arange(8)[::way]]
    return (np.array(centers)[:, None] + ring).reshape(-1, 3), np.repeat(np.arange(16), 12)
