# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes start states before they are needed."""

from __future__ import annotations

from pathlib import Path

from arcgym.scene import InteractiveSceneCfg
from arcgym.sim import SimulationCfg
from arcgym.start_states import store
from arcgym.start_states.errors import StartStateError
from arcgym.start_states.find import find_stored
from arcgym.start_states.making import build_scene, key_of, make
from arcgym.start_states.progress import say
from arcgym.utils.string import did_you_mean


def make_ahead(
    scene_cfg: InteractiveSceneCfg,
    sim_cfg: SimulationCfg,
    until: str,
    speed: float,
    max_time: float,
    *,
    force: bool = False,
    beside_colon: bool = False,
) -> Path:
    """Make the start states of a scene up to a segment's, unless its file has them, and return the file.

    Args:
        scene_cfg: Scene of a task.
        sim_cfg: Settings of the simulation, with the device.
        until: Last segment whose start state is wanted.
        speed: Speed of the expert [m/s].
        max_time: Simulated time after which to give up [s].
        force: Make them though they are there.
        beside_colon: Write them beside the colon's stage instead of into the cache.

    Raises:
        StartStateError: If the colon has no such segment, or the expert does not arrive. What it passed is written.
    """
    scene = build_scene(scene_cfg, sim_cfg)
    colon, endoscope = scene.colon, scene.endoscope
    bounds = colon.stage.segment_bounds()
    if until not in bounds:
        raise StartStateError(f"segment '{until}' is not in {colon.path}. {did_you_mean(until, bounds)}")
    path = store.in_cache(colon, endoscope, key_of(scene))
    if beside_colon:
        path = store.beside_colon(colon.path, endoscope.path, colon.cfg.material)
    if not force and (store.load(path) if beside_colon else find_stored(scene, until)) is not None:
        say(f"start states up to the {until} are there (--force makes them anew)")
        return path
    states, path = make(scene_cfg, sim_cfg, until, speed=speed, max_time=max_time, path=path)
    if until not in states.names:
        raise StartStateError(
            f"the expert of {endoscope.path.name} came {states.about['arc']:.2f} m far, into the {states.names[-1]} "
            f"({states.about['problem']}), and not to the {until}; there are states of {', '.join(states.names)}"
        )
    return path
