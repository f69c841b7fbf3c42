#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turn colon 1 onto the belly without an abdomen and in one, and press on it by hand: three views from the left.

python scripts/tools/abdomen_plot.py docs/images/abdomen.jpg

No scope; in_situ, with weight, after six seconds. Prints how far the colon has gone outside and what it presses with.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

from arcgym.assets import CAPSULE_CFG, AbdomenCfg, ColonCfg
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.sim import Simulation, SimulationCfg, WeightCfg

TIME = 6.0
"""Simulated time [s]."""


@dataclass(frozen=True)
class World:
    """What differs between the views."""

    title: str
    """Its name."""
    posture: str
    """How the patient lies."""
    stiffness: float
    """Of the abdomen [Pa/m]; 0 for none."""
    force: float
    """Of the hand [N]."""


WORLDS = (
    World("on the belly, no abdomen", "prone", 0.0, 0.0),
    World("on the belly, in the abdomen", "prone", 3.0e5, 0.0),
    World("on the back, a hand with 40 N", "supine", 3.0e5, 40.0),
)
"""The views."""


def main() -> None:
    """Run, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=Path, help="picture to write (.jpg)")
    args = parser.parse_args()
    weight = WeightCfg(enabled=True)
    colon = Colon(ColonCfg(material="in_situ", abdomen=AbdomenCfg(enabled=True)))
    sim = Simulation(SimulationCfg(weight=weight), colon, Endoscope(CAPSULE_CFG.copy()), len(WORLDS))
    imaged = colon.data.centerline_pos_w[0].numpy().copy()
    colon.write_abdomen_to_sim(stiffness=torch.tensor([world.stiffness for world in WORLDS]))
    sim.write_gravity(torch.tensor([weight.gravity(world.posture) for world in WORLDS]))
    for _ in range(round(TIME / 0.1)):
        colon.set_hand_pressure(torch.tensor([world.force for world in WORLDS]))
        sim.step(round(0.1 / sim.physics_dt))
    draw(sim, imaged, args.picture)


def front(sim: Any, dent: float) -> np.ndarray:
    """Return the outline of the abdomen's inside where the hand is, seen from the left [m], shape (n, 2): y and z."""
    shape, cfg = sim.surroundings.abdomen.shape, sim.colon.cfg.abdomen
    center, axes = shape.center.numpy()[0], shape.tight.numpy()[0] + cfg.gap
    angle, power = np.linspace(0.0, 2.0 * np.pi, 400), 2.0 / cfg.squareness
    share = (1.0 - abs(cfg.hand_place[0]) ** cfg.squareness) ** (1.0 / cfg.squareness)
    parts = ((np.cos(angle), axes[1]), (np.sin(angle), axes[2]))
    y, z = (np.sign(part) * np.abs(part) ** power * share * axis for part, axis in parts)
    away = np.clip(np.abs(z - cfg.hand_place[1] * axes[2]) / cfg.hand_radius - 1.0, 0.0, 1.0)
    y = y - np.where(y > 0.0, dent * np.cos(0.5 * np.pi * away) ** 2, 0.0)
    return np.stack([center[1] + y, center[2] + z], axis=1)


def draw(sim: Any, imaged: np.ndarray, path: Path) -> None:
    """Draw the worlds side by side, the patient's front to the left."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    data, wall = sim.colon.data, sim.colon.wall
    figure, axes = plt.subplots(1, len(WORLDS), figsize=(8.4, 3.9), sharey=True)
    for k, (axis, world) in enumerate(zip(axes, WORLDS, strict=True)):
        points, line = data.nodal_pos_w[k].numpy(), data.centerline_pos_w[k].numpy()
        outline = front(sim, float(data.hand_dent[k]))
        axis.triplot(-points[:, 1], points[:, 2], wall.triangles, color="tab:pink", linewidth=0.15, alpha=0.5)
        axis.plot(-imaged[:, 1], imaged[:, 2], color="0.5", linewidth=0.8, linestyle="--", label="imaged")
        axis.plot(-line[:, 1], line[:, 2], color="tab:purple", linewidth=1.2, label="now")
        axis.plot(-outline[:, 0], outline[:, 1], color="tab:orange" if world.stiffness else "0.8", linewidth=1.5)
        axis.set_title(world.title, fontsize=9)
        axis.set_aspect("equal")
        axis.tick_params(labelsize=7)
        axis.set_xlabel("to the back [m]", fontsize=8)
        moved = 1000.0 * float(data.nodal_displacement[k].max())
        front_most = 1000.0 * (float(points[:, 1].max()) - float(outline[:, 0].max()))
        print(
            f"{world.title}: moved by up to {moved:.0f} mm, in front of the inside by {front_most:.1f} mm, "
            f"presses with {float(data.abdomen_force[k]):.2f} N, dent {1000.0 * float(data.hand_dent[k]):.1f} mm"
        )
    axes[0].set_ylabel("cranial [m]", fontsize=8)
    axes[0].legend(fontsize=7, loc="lower left")
    figure.tight_layout()
    figure.savefig(path, dpi=90, pil_kwargs={"quality": 60})


if __name__ == "__main__":
    with torch.inference_mode():
        main()
