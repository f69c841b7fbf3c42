# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes start states with the scripted expert of a robot."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg, SnapshotSet
from arcgym.start_states import store
from arcgym.start_states.drive import Drive
from arcgym.start_states.errors import StartStateError
from arcgym.start_states.key import StateKey, state_key
from arcgym.start_states.progress import say, shown
from arcgym.utils.configclass import replace

SPEED = 0.04
"""Speed of the experts unless told otherwise [m/s]."""


def make(
    scene_cfg: InteractiveSceneCfg,
    sim_cfg: SimulationCfg,
    until: str,
    *,
    speed: float = SPEED,
    max_time: float = 180.0,
    path: Path | None = None,
    patient: Path | None = None,
) -> tuple[SnapshotSet, Path]:
    """Drive a robot up a colon and write the start states of the segments that it enters.

    Args:
        scene_cfg: Scene of a task; its colon and robot are taken, one world of each and no sensors.
        sim_cfg: Settings of the simulation, with the device.
        until: Last segment whose start state is wanted.
        speed: Speed of the expert [m/s].
        max_time: Simulated time after which to give up [s].
        path: File to write; the cache's by default.
        patient: Stage of the patient, in place of the scene's first.

    Returns:
        The states, and the file for them. Their ``about["problem"]`` says why the drive ended before its goal; it is
        empty if it arrived. A file that holds more states already is left as it is.

    Raises:
        StartStateError: If the colon has no such segment, or the robot no expert.
    """
    scene = build_scene(scene_cfg, sim_cfg, patient)
    key = key_of(scene)
    bounds = scene.colon.stage.segment_bounds()
    if until not in bounds:
        raise StartStateError(f"Segment '{until}' is not in {scene.colon.path}; it has {', '.join(bounds)}.")
    try:
        drive = Drive(scene, speed=speed, max_time=max_time)
    except ValueError as error:
        raise StartStateError(str(error)) from error
    label = f"start states: {scene.endoscope.path.stem} in {scene.colon.path.parent.name}"
    say(f"{label}, made by {type(drive.expert).__name__} on {scene.device}; this happens once")
    began = time.perf_counter()
    with shown(label, bounds[until][0]) as report:
        drive.run(until, report)
    states = drive.snapshots(store.describe(key, drive.arc, drive.problem, speed))
    path = path or store.in_cache(scene.colon, scene.endoscope, key)
    took = f"{label}: {', '.join(states.names)} after {time.perf_counter() - began:.0f} s"
    stored = store.load(path)
    if stored is not None and len(stored.names) > len(states.names) and not stored.mismatch(scene.sim):
        say(f"{took}; {path} has more and is kept")
    else:
        say(f"{took} -> {path}")
        _write(states, path)
    return states, path


def key_of(scene: InteractiveScene, patient: int = 0) -> StateKey:
    """Return what the start states of a patient of a scene depend on."""
    return state_key(scene.colon, scene.endoscope, scene.sim.cfg, patient)


def build_scene(
    scene_cfg: InteractiveSceneCfg, sim_cfg: SimulationCfg, patient: Path | None = None
) -> InteractiveScene:
    """Return the one world in which a robot is driven, with the patient of a stage or the scene's first."""
    own: dict[str, Any] = {"num_patients": 1} if patient is None else {"usd_path": str(patient), "num_patients": None}
    cfg = InteractiveSceneCfg(num_envs=1, colon=replace(scene_cfg.colon, **own), endoscope=scene_cfg.endoscope)
    return InteractiveScene(cfg, sim_cfg)


def _write(states: SnapshotSet, path: Path) -> None:
    """Write the file; a folder that cannot be written costs the next run its time, not this one its states."""
    try:
        states.save(path)
    except OSError as error:
        say(f"start states cannot be kept in {path.parent} ({error}); set ARCGYM_CACHE to a folder that can be written")
