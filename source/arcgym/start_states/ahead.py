# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes start states before they are needed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from arcgym.scene import InteractiveSceneCfg
from arcgym.sim import SimulationCfg, SnapshotSet
from arcgym.start_states import store
from arcgym.start_states.errors import StartStateError
from arcgym.start_states.find import AT_ONCE, find_stored
from arcgym.start_states.key import state_key
from arcgym.start_states.making import build_scene, key_of, make, make_all
from arcgym.start_states.progress import say
from arcgym.utils.class_type import construct
from arcgym.utils.configclass import replace
from arcgym.utils.string import did_you_mean


def make_all_ahead(
    scene_cfg: InteractiveSceneCfg,
    sim_cfg: SimulationCfg,
    stages: Sequence[Path],
    until: str,
    speed: float,
    max_time: float,
    *,
    force: bool = False,
) -> list[str]:
    """Make the start states of many patients, :data:`arcgym.start_states.find.AT_ONCE` at a time, into the cache.

    Args:
        scene_cfg: Scene of a task.
        sim_cfg: Settings of the simulation, with the device.
        stages: Stages of the patients.
        until: Last segment whose start state is wanted.
        speed: Speed of the first world's expert [m/s].
        max_time: Simulated time after which to give up a patient [s].
        force: Make them though they are there.

    Returns:
        One line for each patient in which the expert does not arrive; what it passed is written.
    """
    failures: list[str] = []
    for first in range(0, len(stages), AT_ONCE):
        some = stages[first : first + AT_ONCE]
        found, lacking = _in_cache(scene_cfg, sim_cfg, some, until)
        failures += [f"{stage}: there is no segment '{until}'" for stage in lacking]
        sets = {} if force else found
        missing = [stage for stage in some if stage not in sets and stage not in lacking]
        say(f"patients {first + 1} to {first + len(some)} of {len(stages)}: {len(missing)} without start states")
        if missing:
            made = make_all(scene_cfg, sim_cfg, until, missing, speed=speed, max_time=max_time)
            sets |= {stage: states for stage, (states, _) in zip(missing, made, strict=True)}
        ended = {stage: states.about for stage, states in sets.items() if until not in states.names}
        failures += [f"{stage}: {about['arc']:.2f} m, {about['problem']}" for stage, about in ended.items()]
    return failures


def _in_cache(
    scene_cfg: InteractiveSceneCfg, sim_cfg: SimulationCfg, stages: Sequence[Path], until: str
) -> tuple[dict[Path, SnapshotSet], list[Path]]:
    """Return cached states of patients whose drive has ended at a segment or before it, and those without it."""
    paths = [str(stage) for stage in stages]
    colon = construct(replace(scene_cfg.colon, usd_path=paths, num_patients=None))
    endoscope = construct(scene_cfg.endoscope)
    found: dict[Path, SnapshotSet] = {}
    for patient, stage in enumerate(stages):
        key = state_key(colon, endoscope, sim_cfg, patient)
        states = store.load(store.in_cache(colon, endoscope, key, patient))
        if states is not None and (until in states.names or states.about.get("problem")):
            found[stage] = states
    return found, [stage for patient, stage in zip(colon.patients, stages, strict=True) if until not in patient.bounds]


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
