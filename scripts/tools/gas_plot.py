#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Suck the lumen of colon 1 empty and insufflate it again, in_situ: three views, and pressure over volume.

python scripts/tools/gas_plot.py docs/images/gas.jpg
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch

from arcgym.assets import CAPSULE_CFG, ColonCfg, GasCfg
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.assets.gas_cfg import MMHG
from arcgym.sensors import SkinnedSurface
from arcgym.sim import Simulation, SimulationCfg
from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg

FLOW = 6.0
"""Flow in and out [l/min]: fast against a colonoscope's, slow against the wall's motion."""
HIGHEST = 60.0
"""Pressure at which insufflation ends [mmHg]."""
LONGEST = 60.0
"""Time that suction and insufflation may take each [s]."""


@dataclass
class Course:
    """Pressure [mmHg] and volume [ml] after every control step."""

    volume: list[float] = field(default_factory=list)
    pressure: list[float] = field(default_factory=list)


def main() -> None:
    """Run, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=Path, help="picture to write (.jpg)")
    args = parser.parse_args()
    colon = Colon(ColonCfg(material="in_situ", gas=GasCfg(enabled=True, leak_conductance=0.0)))
    sim = Simulation(SimulationCfg(), colon, Endoscope(CAPSULE_CFG.copy()), 1)
    draw = view_of(sim)
    views, courses = [("imaged, 20 mmHg", draw())], {"sucked empty": Course(), "insufflated": Course()}
    gas = colon.cfg.gas
    empty = (gas.abdominal_pressure - 0.95 * gas.suction_depth) / MMHG
    follow(sim, -FLOW, courses["sucked empty"], lambda now: now < empty)
    views.append((f"collapsed, {courses['sucked empty'].pressure[-1]:.0f} mmHg", draw()))
    follow(sim, FLOW, courses["insufflated"], lambda now: now > HIGHEST)
    views.append((f"insufflated, {courses['insufflated'].pressure[-1]:.0f} mmHg", draw()))
    for name, course in courses.items():
        print(f"{name}: {course.volume[0]:.0f} ml to {course.volume[-1]:.0f} ml, {course.pressure[-1]:.1f} mmHg")
    plot(views, courses, args.picture)


def follow(sim: Any, flow: float, course: Course, done: Callable[[float], bool]) -> None:
    """Let gas flow [l/min] until its pressure [mmHg] says that it is done."""
    for _ in range(round(LONGEST / 0.1)):
        sim.colon.set_gas_flow(torch.tensor([flow / 60000.0]))
        sim.step(round(0.1 / sim.physics_dt))
        course.volume.append(1.0e6 * sim.colon.data.lumen_volume.item())
        course.pressure.append(sim.colon.data.lumen_pressure.item() / MMHG)
        if done(course.pressure[-1]):
            return


def view_of(sim: Any) -> Callable[[], np.ndarray]:
    """Return a function that draws the colon from the front, without the scope."""
    stage, wall = sim.colon.stage, sim.colon.wall
    surface = SkinnedSurface(stage.visual_proxy, wall, 1, sim.device)
    speck = np.full(1, 1.0e-6)
    view = OutsideView(OutsideViewCfg(width=420, height=480), surface, stage.visual_proxy.points, speck, speck, speck)

    def draw() -> np.ndarray:
        surface.update(sim.nodal_pos)
        return view.render(np.array([[0.0, 0.0, -0.02]]), np.array([[0.0, 0.0, 0.0, 1.0]]), np.zeros(1))

    return draw


def plot(views: list[tuple[str, np.ndarray]], courses: dict[str, Course], path: Path) -> None:
    """Put the views and the courses side by side."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 4, figsize=(11.0, 3.0), width_ratios=(1, 1, 1, 1.15))
    for axis, (title, picture) in zip(axes, views, strict=False):
        axis.imshow(picture)
        axis.set_title(title, fontsize=9)
        axis.axis("off")
    for name, course in courses.items():
        axes[3].plot(course.volume, course.pressure, label=name)
    axes[3].axhline(20.0, color="0.6", linewidth=0.8)
    axes[3].axhline(6.5, color="0.6", linewidth=0.8, linestyle="--")
    axes[3].set_xlabel("volume [ml]", fontsize=8)
    axes[3].set_ylabel("pressure in the lumen [mmHg]", fontsize=8)
    axes[3].tick_params(labelsize=7)
    axes[3].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=100, pil_kwargs={"quality": 80})


if __name__ == "__main__":
    main()
