# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes start states with the scripted expert of a robot."""

from __future__ import annotations

import time
from collections.abc import Sequence
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
MAX_TIME = 240.0
"""Simulated time after which a drive gives up a patient unless told otherwise [s]."""
CPU_WORLDS, GPU_WORLDS = 4, 12
"""Worlds for each patient: on a CPU each costs time, on a GPU next to none."""


def make(
    scene_cfg: InteractiveSceneCfg,
    sim_cfg: SimulationCfg,
    until: str,
    *,
    speed: float = SPEED,
    max_time: float = MAX_TIME,
    path: Path | None = None,
    patient: Path | None = None,
) -> tuple[SnapshotSet, Path]:
    """Drive a robot up a colon and write the start states of the segments that it enters.

    Args:
        scene_cfg: Scene of a task; its colon and robot are taken, and no sensors.
        sim_cfg: Settings of the simulation, with the device.
        until: Last segment whose start state is wanted.
        speed: Speed of the first world's expert [m/s].
        max_time: Simulated time after which to give up [s].
        path: File to write; the cache's by default.
        patient: Stage of the patient, in place of the scene's first.

    Returns:
        The states, and the file for them. Their ``about["problem"]`` says why the drive ended before its goal; it is
        empty if it arrived. A file that holds more states already is left as it is.

    Raises:
        StartStateError: If the colon has no such segment, or the robot no expert.
    """
    patients = None if patient is None else [patient]
    return make_all(scene_cfg, sim_cfg, until, patients, speed=speed, max_time=max_time, path=path)[0]


def make_all(
    scene_cfg: InteractiveSceneCfg,
    sim_cfg: SimulationCfg,
    until: str,
    patients: Sequence[Path] | None = None,
    *,
    speed: float = SPEED,
    max_time: float = MAX_TIME,
    path: Path | None = None,
) -> list[tuple[SnapshotSet, Path]]:
    """Drive a robot up several colons at once, see :func:`make`; states and file of each.

    Args:
        scene_cfg: Scene of a task.
        sim_cfg: Settings of the simulation.
        until: Last segment whose start state is wanted.
        patients: Stages of the patients; None for the scene's first.
        speed: Speed of the first world's expert [m/s].
        max_time: Simulated time after which to give up a patient [s].
        path: File of the first patient; the cache's by default.

    Raises:
        StartStateError: If a colon has no such segment, or the robot no expert.
    """
    scene = build_scene(scene_cfg, sim_cfg, patients)
    for patient in scene.colon.patients:
        if until not in patient.bounds:
            raise StartStateError(f"Segment '{until}' is not in {patient.path}; it has {', '.join(patient.bounds)}.")
    try:
        drive = Drive(scene, speed=speed, max_time=max_time)
    except ValueError as error:
        raise StartStateError(str(error)) from error
    label = f"start states: {scene.endoscope.path.stem} in {_names(scene)}"
    say(f"{label}, made by {type(drive.expert).__name__} on {scene.device}; this happens once")
    began = time.perf_counter()
    with shown(label, drive.bounds[until][0]) as report:
        drive.run(until, report)
    took = time.perf_counter() - began
    return [_keep(drive, patient, speed, path, took) for patient in range(len(drive.routes))]


def _names(scene: InteractiveScene) -> str:
    """Return the patient of a scene, or how many it has, in words."""
    patients = scene.colon.patients
    return patients[0].name if len(patients) == 1 else f"{len(patients)} patients"


def _keep(drive: Drive, patient: int, speed: float, path: Path | None, took: float) -> tuple[SnapshotSet, Path]:
    """Write the states of a patient, unless its file has more; return both."""
    scene, route = drive.scene, drive.routes[patient]
    key = key_of(scene, patient)
    states = drive.snapshots(store.describe(key, route.arc, route.failure, speed), patient)
    path = path or store.in_cache(scene.colon, scene.endoscope, key, patient)
    name = scene.colon.patients[patient].name
    said = f"start states: {scene.endoscope.path.stem} in {name}: {', '.join(states.names)} after {took:.0f} s"
    stored = store.load(path)
    if stored is not None and len(stored.names) > len(states.names) and not stored.mismatch(scene.sim, patient):
        say(f"{said}; {path} has more and is kept")
    else:
        say(f"{said} -> {path}")
        _write(states, path)
    return states, path


def key_of(scene: InteractiveScene, patient: int = 0) -> StateKey:
    """Return what the start states of a patient of a scene depend on."""
    return state_key(scene.colon, scene.endoscope, scene.sim.cfg, patient)


def build_scene(
    scene_cfg: InteractiveSceneCfg, sim_cfg: SimulationCfg, patients: Sequence[Path] | None = None
) -> InteractiveScene:
    """Return the worlds in which a robot is driven, some for each patient or in the scene's first.

    There is gas only where it keeps the wall under tension, and then at the pressure of the image.
    """
    own: dict[str, Any] = {"num_patients": 1}
    if patients is not None:
        own = {"usd_path": [str(patient) for patient in patients], "num_patients": None}
    gas = scene_cfg.colon.gas
    own["gas"] = replace(gas, enabled=gas.tense, start_pressure=None)
    colon, worlds = replace(scene_cfg.colon, **own), CPU_WORLDS if sim_cfg.device == "cpu" else GPU_WORLDS
    count = worlds * (1 if patients is None else len(patients))
    return InteractiveScene(InteractiveSceneCfg(num_envs=count, colon=colon, endoscope=scene_cfg.endoscope), sim_cfg)


def _write(states: SnapshotSet, path: Path) -> None:
    """Write the file; a folder that cannot be written costs the next run its time, not this one its states."""
    try:
        states.save(path)
    except OSError as error:
        say(f"start states cannot be kept in {path.parent} ({error}); set ARCGYM_CACHE to a folder that can be written")
