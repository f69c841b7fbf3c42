# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states of the shipped colons, left alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.rows import Plot, Row, Run
from arcgym.benchmarks.worlds import load_env_cfg

COLONS = ("colon_1", "colon_2", "colon_3", "colon_4", "colon_5", "ct_1", "ct_2")
"""Colons that ship."""
BOUND = 0.05
"""Largest change of a force."""


def start_rest(run: Run, robot: str, material: str, colons: Sequence[str] = COLONS) -> list[Row]:
    """Measure how far forces change in three seconds from the first control step's, in every shipped start state.

    The largest force on a window of scope, and the push on the base of a robot that has one.
    """
    from arcgym.start_states.shipped import load

    shipped = load(robot, material, colons, run.device)
    names = [f"{shipped.colon(patient)} {segment}" for patient, segment in shipped.keys]
    return _row(run, f"start_rest_{robot}_{material}", names, shipped.left_alone(shipped.keys))


def start_rest_clinical(run: Run, robot: str, until: str) -> list[Row]:
    """Measure the same with all clinical effects in colon 1; its states are made if there are none that fit."""
    import torch

    from arcgym import start_states
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.start_states.settling import forces_alone

    cfg, sim_cfg = clinical_scene(robot, run.device)
    states = start_states.ensure(InteractiveScene(cfg, sim_cfg), until)
    cfg.num_envs = len(states.names)
    scene = InteractiveScene(cfg, sim_cfg)
    scene.sim.load_snapshots(states)
    scene.sim.write_snapshot(torch.arange(cfg.num_envs, device=scene.device))
    scene.sim.forward()
    return _row(run, f"start_rest_{robot}_clinical", states.names, forces_alone(scene))


def _row(run: Run, name: str, states: Sequence[str], forces: np.ndarray) -> list[Row]:
    """Return the row of forces [N], shape (T, N, 2): window and base, in N states."""
    from arcgym.start_states.settling import CONTROL_STEP, changes

    change = changes(forces)
    step, world, kind = (int(index) for index in np.unravel_index(int(np.argmax(change)), change.shape))
    most = change.max(axis=(0, 2))
    plot = Plot(name, "time [s]", "largest force on a window [N]")
    time = CONTROL_STEP * np.arange(1, len(forces) + 1)
    worst = most.argsort()[::-1].tolist()
    plot.points += [(f"start of the {states[k]}", time, forces[:, k, 0]) for k in worst[:7]]
    run.plots.append(plot)
    note = f"{('window', 'base')[kind]} at the start of the {states[world]}; {int((most > BOUND).sum())} of {len(most)}"
    note += " over the bound; largest changes " + ", ".join(f"{states[k]} {most[k]:.1%}" for k in worst[:5])
    value, reference = float(forces[step, world, kind]), float(forces[0, world, kind])
    return [Row(name, value, reference, float(change.max()), BOUND, "N", note)]


def clinical_scene(robot: str, device: str) -> tuple[Any, Any]:
    """Return the configurations of scene and simulation of a robot in ``env.clinical=[all]``."""
    from arcgym.scene import InteractiveSceneCfg

    task = load_env_cfg(f"ARC-Sigmoid-{robot.capitalize()}", ["env.clinical=[all]"], 0, device=device)
    task.resolve()
    own = {"colon": task.scene.colon, "endoscope": task.scene.endoscope}
    return InteractiveSceneCfg(num_envs=1, **own), task.sim
