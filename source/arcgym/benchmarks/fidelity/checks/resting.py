# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states of colon 1, left alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.pushes import CONTROL_STEP
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run
from arcgym.benchmarks.worlds import load_env_cfg

REST_TIME = 3.0
"""Time without commands [s]."""
LEAST = 0.1
"""Force below which changes are compared with it [N]."""
UNTIL = "splenic"
"""Last segment that colon 1 has start states of beside its stage."""
CLINICAL = "clinical"
"""Tissue that stands for all of ``env.clinical=[all]``."""


def start_rest(run: Run, robot: str, material: str, until: str = UNTIL) -> list[Row]:
    """Measure how far forces change in three seconds from the first control step's, in every start state.

    The largest force on a window of scope, and the push on the base of a robot that has one. The states are those that
    tasks start from: they are made if there are none that fit.
    """
    names, force = rest(run, robot, material, until)
    change = np.abs(force - force[0]) / np.maximum(force[0], LEAST)
    step, world, kind = np.unravel_index(int(np.argmax(change)), change.shape)
    name = f"start_rest_{robot}_{material}"
    plot = Plot(name, "time [s]", "largest force on a window [N]")
    time = CONTROL_STEP * np.arange(1, len(force) + 1)
    plot.points += [(f"start of the {segment}", time, force[:, k, 0]) for k, segment in enumerate(names)]
    run.plots.append(plot)
    note = f"{('window', 'base')[kind]} at the start of the {names[world]}; largest changes "
    note += ", ".join(f"{segment} {change[:, k].max():.1%}" for k, segment in enumerate(names))
    value, reference = float(force[step, world, kind]), float(force[0, world, kind])
    return [Row(name, value, reference, float(change.max()), 0.05, "N", note)]


def rest(run: Run, robot: str, material: str, until: str) -> tuple[tuple[str, ...], np.ndarray]:
    """Return names of start states, and forces in each without commands [N], shape (T, N, 2): window and base."""
    import torch

    from arcgym import start_states
    from arcgym.scene.interactive_scene import InteractiveScene

    cfg, sim_cfg = scene(robot, material, run.device)
    states = start_states.ensure(InteractiveScene(cfg, sim_cfg), until)
    cfg.num_envs = len(states.names)
    sim = InteractiveScene(cfg, sim_cfg).sim
    sim.load_snapshots(states)
    sim.write_snapshot(torch.arange(cfg.num_envs, device=sim.device))
    sim.forward()
    samples: list[Any] = []
    for _ in range(round(REST_TIME / CONTROL_STEP)):
        sim.step(round(CONTROL_STEP / sim.physics_dt))
        data = sim.endoscope.data
        samples.append(torch.stack([data.window_force_norm.amax(dim=1), data.base_force.abs()], dim=1).cpu().numpy())
    return states.names, np.array(samples, dtype=float)


def scene(robot: str, material: str, device: str) -> tuple[Any, Any]:
    """Return the configurations of scene and simulation of a robot in a tissue; in ``clinical`` with all effects."""
    from arcgym import assets
    from arcgym.scene import InteractiveSceneCfg
    from arcgym.sim import SimulationCfg

    if material == CLINICAL:
        task = load_env_cfg(f"ARC-Sigmoid-{robot.capitalize()}", ["env.clinical=[all]"], 0, device=device)
        task.resolve()
        own = {"colon": task.scene.colon, "endoscope": task.scene.endoscope}
        return InteractiveSceneCfg(num_envs=1, **own), task.sim
    endoscope = getattr(assets, f"{robot.upper()}_CFG")
    colon = assets.ColonCfg(material=material)
    return InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=endoscope), SimulationCfg(device=device)
