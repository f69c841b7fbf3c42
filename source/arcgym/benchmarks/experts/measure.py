# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the expert of a robot up several patients at once, and notes how far it came in each."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.assets import CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG, ColonCfg
from arcgym.benchmarks.experts.ways import Ways
from arcgym.benchmarks.worlds import OUT_OF_TIME, load_env_cfg
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg
from arcgym.start_states import Drive, store
from arcgym.start_states.halts import Halt, go_on, halt_of
from arcgym.start_states.making import SPEED, key_of
from arcgym.start_states.route import Route, what_holds
from arcgym.start_states.settling import CONTROL_STEP
from arcgym.utils.configclass import replace, validate

ROBOTS = {"capsule": CAPSULE_CFG, "magnetic": MAGNETIC_CFG, "proximal": PROXIMAL_CFG}
"""Robots by name."""

HALT_EVERY = 30.0
"""Simulated time after which drives under way are kept again, should the process be killed [s]."""


@dataclass(frozen=True)
class Attempt:
    """One robot in one tissue, with some worlds for each patient of a batch."""

    robot: str
    """Name out of :data:`ROBOTS`."""
    tissue: str
    """Tissue preset."""
    worlds: int
    """Worlds for each patient."""
    max_time: float
    """Simulated time after which the drive gives up a patient [s]."""
    device: str
    """Device of the simulation."""
    seed: int = 0
    """Seed of the experts' settings."""
    deadline: float = float("inf")
    """Time of :func:`time.monotonic` at which it gives up the patients that are under way [s]."""
    keep_states: bool = False
    """Whether to keep the start states in the cache folder."""
    patience: float = 30.0
    """Simulated time without progress after which the drive gives up a patient [s]."""
    length: float | None = None
    """Length of a scope with a shaft [m]; None takes the shipped one's, and capsules have none."""
    overrides: tuple[str, ...] = ()
    """Overrides of the robot's task, such as ``env.clinical=[all]``."""
    halts: Path | None = None
    """Folder in which drives under way are kept, and from which they go on if they are stopped; None for none."""
    ways: Path | None = None
    """Folder in which states on the way of each patient's foremost world are kept; None for none."""

    @property
    def label(self) -> str:
        """Tissue and overrides, as rows have them."""
        return " ".join((self.tissue, *self.overrides))


def attempt(
    plan: Attempt,
    stages: Sequence[Path],
    done: Callable[[dict[str, Any]], None],
    tell: Callable[[str], None] = lambda text: None,
) -> None:
    """Drive up all patients of a batch.

    Args:
        plan: What drives, and how long.
        stages: Stages of the patients.
        done: Called with the row of each patient as soon as the drive has ended there.
        tell: Called with a line about all of them every 10 simulated seconds.
    """
    scene = build(plan, stages)
    drive = Drive(scene, patience=plan.patience, max_time=plan.max_time, seed=plan.seed)
    _go_on(plan, drive)
    began, written, ways = time.monotonic(), set[int](), Ways()

    def report(drive: Drive) -> None:
        for patient, route in enumerate(drive.routes):
            if plan.ways is not None:
                ways.keep(drive, patient, plan.ways / _name(plan, drive, patient))
            if route.running and time.monotonic() > plan.deadline:
                route.problem, route.held_by = OUT_OF_TIME, what_holds(scene, drive.foremost[patient])
                _keep_halt(plan, drive, patient)
            if not route.running and patient not in written:
                written.add(patient)
                about = {"robot": plan.robot, "tissue": plan.label, "worlds": plan.worlds, "seed": plan.seed}
                about |= {} if plan.length is None else {"scope_length": plan.length}
                spent = {"wall_time": round(time.monotonic() - began, 1)}
                done({"patient": scene.colon.patients[patient].name, **about, **row_of(route), **spent})
            elif route.running and round(drive.time / CONTROL_STEP) % round(HALT_EVERY / CONTROL_STEP) == 0:
                _keep_halt(plan, drive, patient)

        if round(drive.time / CONTROL_STEP) % 100 == 0:
            tell(_progress(drive, time.monotonic() - began))

    drive.run("cecum", report, settled=plan.keep_states)
    if plan.keep_states:
        _keep(scene, drive)


def _name(plan: Attempt, drive: Drive, patient: int) -> str:
    """Return a name of patient, scope and tissue, for files and folders."""
    return "-".join((drive.scene.colon.patients[patient].name, drive.scene.endoscope.path.stem, *plan.label.split()))


def _halt(folder: Path, plan: Attempt, drive: Drive, patient: int) -> Path:
    """Return the file of a drive that was stopped from outside."""
    return folder / f"{_name(plan, drive, patient)}.npz"


def _keep_halt(plan: Attempt, drive: Drive, patient: int) -> None:
    """Keep a drive that is under way, if there is a folder for it."""
    if plan.halts is not None:
        halt_of(drive, patient).save(_halt(plan.halts, plan, drive, patient))


def _go_on(plan: Attempt, drive: Drive) -> None:
    """Let the drive go on where another one was stopped, in the patients in which one was."""
    if plan.halts is None:
        return
    for patient in range(len(drive.routes)):
        halt = Halt.load(_halt(plan.halts, plan, drive, patient))
        if halt is not None:
            go_on(drive, patient, halt)


def build(plan: Attempt, stages: Sequence[Path]) -> InteractiveScene:
    """Return the worlds of a batch; with overrides, those of the robot's task without its camera."""
    colon, sim = ColonCfg(material=plan.tissue), SimulationCfg(device=plan.device)
    endoscope = ROBOTS[plan.robot]
    if plan.overrides:
        words = (f"env.scene.colon.material={plan.tissue}", *plan.overrides)
        task = load_env_cfg(f"ARC-Cecum-{plan.robot.title()}", words, plan.seed, device=plan.device)
        validate(task)
        task.resolve()
        colon, sim, endoscope = task.scene.colon, task.sim, task.scene.endoscope
    colon = replace(colon, usd_path=[str(stage) for stage in stages], num_patients=None)
    endoscope = replace(endoscope, length=None if plan.robot == "capsule" else plan.length)
    cfg = InteractiveSceneCfg(num_envs=plan.worlds * len(stages), colon=colon, endoscope=endoscope)
    return InteractiveScene(cfg, sim)


def _progress(drive: Drive, spent: float) -> str:
    """Return where the tips are, after so much time [s]."""
    arcs = sorted(route.arc for route in drive.routes)
    left = sum(route.running for route in drive.routes)
    way = f"{arcs[0]:.2f} to {arcs[-1]:.2f} m, median {arcs[len(arcs) // 2]:.2f} m"
    return f"{drive.time:.0f} s simulated in {spent:.0f} s: {way}; {left} of {len(arcs)} patients under way"


def row_of(route: Route) -> dict[str, Any]:
    """Return what is written down of one patient."""
    end = max(end for _, end in route.bounds.values())
    entries = {name: dataclasses.asdict(entry) for name, entry in route.entries.items()}
    figures = {"length": round(end, 4), "reached": round(route.arc, 4), "time": round(route.time, 1)}
    return figures | {"segments": entries, "problem": route.problem, "held_by": route.held_by}


def _keep(scene: InteractiveScene, drive: Drive) -> None:
    """Write the start states of each patient into the cache folder."""
    for patient, route in enumerate(drive.routes):
        key = key_of(scene, patient)
        about = store.describe(key, route.arc, route.failure, SPEED)
        drive.snapshots(about, patient).save(store.in_cache(scene.colon, scene.endoscope, key, patient))
