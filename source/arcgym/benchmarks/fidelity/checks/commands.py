# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Whatever the actions of the tasks can command, no link leaves the lumen and every world stays finite.

Each robot starts in the bend of 100 degrees, in the softest tissue. Commands are the tasks' own, limits included.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.placement import follow
from arcgym.benchmarks.fidelity.processes import in_processes
from arcgym.benchmarks.fidelity.pushes import BEND, CONTROL_STEP
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute
from arcgym.benchmarks.lumen import LumenCheck

ROBOTS = ("capsule", "magnetic", "proximal")
"""All robots."""
START = 0.19
"""Inserted length at the start [m]: the tip is in the bend."""
SPEED_TIME = 4.0
"""Time for which each command is kept [s]."""
RANDOM_WORLDS = 20
"""Worlds of random actions."""
RANDOM_SHARE = 5
"""Worlds of them in a process, on a CPU."""
RANDOM_TIME = 30.0
"""Time of each of them [s]: ten minutes in all."""
REDRAW = 0.2
"""Chance a control step that a world's random action is drawn anew."""


def scene(run: Run, robot: str, num_envs: int) -> Any:
    """Return worlds with a robot, its tip in the bend."""
    from arcgym import assets

    sim = build(run, getattr(assets, f"{robot.upper()}_CFG"), BEND, num_envs, {"material": "in_situ"})
    if robot == "capsule":
        center, angle = BEND.frame(np.array([START]))
        half = -0.5 * float(angle[0])
        pose = [*center[0], math.sin(half), 0.0, 0.0, math.cos(half)]
        sim.endoscope.data.joint_pos[:] = sim.endoscope.data.joint_pos.new_tensor(pose)
        sim.contact.ring.fill_(-1)
        sim.forward()
    else:
        follow(sim, BEND, START)
    sim.step(24)
    return sim


def limits(robot: str) -> Any:
    """Return the action term of the robot's tasks."""
    import arcgym_tasks  # noqa: F401
    from arcgym.utils.registry import load_cfg_from_registry

    cfg = load_cfg_from_registry(f"ARC-Sigmoid-{robot.capitalize()}", "env_cfg_entry_point")
    (term,) = [value for value in vars(cfg.actions).values() if hasattr(value, "class_type")]
    return term


def commander(sim: Any, robot: str) -> tuple[int, Callable[[Any], None]]:
    """Return the number of actions, and the function that gives actions in [-1, 1], shape (N, A), to the robot."""
    term, scope = limits(robot), sim.endoscope
    if "tip" in scope.actuators:

        def pull(action: Any) -> None:
            scope.set_tip_velocity_command(term.linear_scale * action[:, :3], term.angular_scale * action[:, 3:])

        return 6, pull

    def push(action: Any) -> None:
        scope.set_insertion_command(term.insertion_scale * action[:, 0], term.roll_scale * action[:, 1])
        target = scope.data.bending + term.bending_scale * CONTROL_STEP * action[:, 2:]
        scope.set_bending_command(target[:, 0], target[:, 1])

    return 4, push


@dataclass
class Watched:
    """What was seen of worlds: links outside the lumen, worlds that are not finite, forces."""

    worlds: np.ndarray
    """Which worlds had either, shape (N,)."""
    outside: int = 0
    """Links outside, counted once a control step."""
    broken: int = 0
    """Worlds that are not finite at the end."""
    force: list[np.ndarray] = field(default_factory=list)
    """Largest force on a window by control step [N], shape (N,) each."""

    def join(self, other: Watched) -> None:
        """Add what was seen of other worlds in the same control steps."""
        self.worlds = np.concatenate([self.worlds, other.worlds])
        self.outside, self.broken = self.outside + other.outside, self.broken + other.broken
        self.force = [np.concatenate(pair) for pair in zip(self.force, other.force, strict=True)]

    def plot(self, name: str) -> Plot:
        """Draw the largest force on a window over time, in the worst of the worlds and in the median one."""
        time, force = CONTROL_STEP * np.arange(1, len(self.force) + 1), np.array(self.force)
        plot = Plot(name, "time [s]", "largest force on a window [N]")
        plot.points += [("worst world", time, force.max(axis=1)), ("median world", time, np.median(force, axis=1))]
        return plot

    def row(self, name: str, what: str) -> Row:
        """Return the events counted; each world that is not finite at the end is one."""
        note = f"{what}: {self.worlds.sum()} of {len(self.worlds)} worlds, {self.broken} not finite"
        return absolute(name, float(self.outside + self.broken), 0.0, 0.0, "", note)


class Watch:
    """Counts links outside the lumen and worlds that are not finite, control step by control step."""

    def __init__(self, sim: Any):
        """Watch a simulation."""
        self._sim, self._check = sim, LumenCheck(sim)
        self.seen = Watched(np.zeros(sim.num_envs, bool))

    def look(self) -> None:
        """Count the present state."""
        outside, _ = self._check.outside()
        lost = self._sim.non_finite
        outside = outside & ~lost[:, None]
        self.seen.outside += int(outside.sum())
        self.seen.broken = int(lost.sum())
        self.seen.worlds |= (outside.any(dim=1) | lost).cpu().numpy()
        self.seen.force.append(self._sim.endoscope.data.window_force_norm.amax(dim=1).cpu().numpy())


def speeds(run: Run, robot: str) -> list[Row]:
    """Give every combination of full commands to a world of its own; all three turns of a tip go together."""
    import torch

    corners = torch.tensor(list(itertools.product((-1.0, 1.0), repeat=4)), device=run.device)
    sim = scene(run, robot, len(corners))
    actions, command = commander(sim, robot)
    corners = torch.cat([corners, *[corners[:, 3:]] * (actions - 4)], dim=1)
    watch = Watch(sim)
    for _ in range(round(SPEED_TIME / CONTROL_STEP)):
        command(corners)
        sim.step(round(CONTROL_STEP / sim.physics_dt))
        watch.look()
    run.plots.append(watch.seen.plot(f"speed_{robot}"))
    return [watch.seen.row(f"speed_{robot}", f"full commands for {SPEED_TIME:g} s")]


def random_actions(run: Run, robot: str) -> list[Row]:
    """Give uniform actions, each kept for five control steps on average; on a CPU each five worlds are a process."""
    share = RANDOM_WORLDS if run.device.startswith("cuda") else RANDOM_SHARE
    tasks = [(robot, first, share, run.device, run.folder) for first in range(0, RANDOM_WORLDS, share)]
    watches = in_processes(watch_random, tasks)
    both = watches[0]
    for watch in watches[1:]:
        both.join(watch)
    run.plots.append(both.plot(f"random_{robot}"))
    return [both.row(f"random_{robot}", f"{RANDOM_WORLDS * RANDOM_TIME / 60.0:g} min")]


def watch_random(robot: str, first: int, count: int, device: str, folder: Path) -> Watched:
    """Give the worlds from the first on the random actions that are theirs among all, and return what was seen."""
    import torch

    torch.set_num_threads(1)
    own = folder / f"random_{robot}_{first}"
    own.mkdir(parents=True, exist_ok=True)
    sim = scene(Run(device, own), robot, count)
    actions, command = commander(sim, robot)
    draw = torch.Generator().manual_seed(1)
    action, watch = torch.zeros(RANDOM_WORLDS, actions), Watch(sim)
    for _ in range(round(RANDOM_TIME / CONTROL_STEP)):
        fresh = 2.0 * torch.rand(RANDOM_WORLDS, actions, generator=draw) - 1.0
        action = torch.where(torch.rand(RANDOM_WORLDS, 1, generator=draw) < REDRAW, fresh, action)
        command(action[first : first + count].to(sim.device))
        sim.step(round(CONTROL_STEP / sim.physics_dt))
        watch.look()
    return watch.seen
