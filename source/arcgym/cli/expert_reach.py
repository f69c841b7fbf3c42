# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the scripted expert of each robot gets in a colon."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROBOTS = ("capsule", "magnetic", "proximal")
"""Robots whose experts are driven."""


@dataclass(frozen=True)
class Reach:
    """How far one expert got."""

    robot: str
    """Name of the robot."""
    reached_m: float
    """Largest arc length of its tip [m]."""
    length_m: float
    """Length of the colon [m]."""
    segment: str
    """Last segment that it entered."""
    simulated_s: float
    """Simulated time [s]."""
    elapsed_s: float
    """Time that took [s]."""
    problem: str
    """Why it ended before the cecum; empty if it arrived there."""

    def __str__(self) -> str:
        """One line."""
        end = self.problem or "arrived"
        where = f"{self.reached_m:.2f} of {self.length_m:.2f} m, into the {self.segment}"
        return f"expert of {self.robot}: {where}, in {self.simulated_s:.0f} s ({end})"


def expert_reach(path: Path, robots: Sequence[str], max_time: float) -> Iterator[Reach]:
    """Drive the experts up a colon, one after the other, and yield how far each got.

    Args:
        path: Stage of the colon.
        robots: Names out of :data:`ROBOTS`.
        max_time: Simulated time after which each gives up [s].
    """
    from arcgym.assets import CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG, ColonCfg
    from arcgym.scene import InteractiveSceneCfg
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.sim import SimulationCfg
    from arcgym.start_states import Drive

    configs = dict(zip(ROBOTS, (CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG), strict=True))
    for robot in robots:
        began = time.perf_counter()
        colon = ColonCfg(usd_path=str(path.resolve()))
        scene = InteractiveScene(
            InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=configs[robot]), SimulationCfg()
        )
        drive = Drive(scene, max_time=max_time)
        drive.run(list(drive.bounds)[-1], settled=False)
        segment = max(drive.states, key=lambda name: drive.bounds[name][0])
        length = max(end for _, end in drive.bounds.values())
        seconds = time.perf_counter() - began
        yield Reach(robot, drive.arc, length, segment, drive.time, round(seconds, 1), drive.problem)
