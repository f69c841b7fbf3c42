# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the pushed colonoscope up several patients at once and keeps the history of one insertion of each."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.benchmarks.clinical.pausing import pause, resume
from arcgym.benchmarks.clinical.record import FIELDS, Diary, RecordedExaminer, RecordedPushExpert
from arcgym.benchmarks.worlds import OUT_OF_TIME, load_env_cfg
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.start_states import Drive
from arcgym.start_states.making import SPEED
from arcgym.start_states.route import what_holds
from arcgym.start_states.settling import CONTROL_STEP
from arcgym.utils.configclass import replace, validate

TASK = "ARC-Cecum-Proximal"
"""Task whose scene is taken."""
COLONOSCOPE = "env.scene.endoscope.length=null"
"""Override of the task's longer scope by one as long as colonoscopes, those of the published insertions, are."""
EXAMINER_SPEED = 0.015
"""Speed of the examiner's script [m/s]; a choice, real tips come on by 2 to 6 mm/s."""
KEPT_EVERY = 200
"""Control steps after which insertions that are under way are written down."""


@dataclass(frozen=True)
class Plan:
    """Insertions with one set of overrides."""

    name: str
    """Name in the table."""
    overrides: tuple[str, ...]
    """Overrides of the task, such as ``env.clinical=[all]``."""
    worlds: int
    """Worlds for each patient, which work together; one alone keeps the expert's shipped settings."""
    max_time: float
    """Simulated time after which an insertion is given up [s]."""
    patience: float
    """Simulated time without progress after which it is given up [s]."""
    device: str
    """Device of the simulation."""
    examiner: bool = False
    """Whether the script pushes gently and pulls back, :class:`arcgym.experts.ExaminerExpert`."""
    speed: float | None = None
    """Speed of the script [m/s]; None for the script's own."""
    seed: int = 0
    """Seed of the experts' settings."""
    deadline: float = float("inf")
    """Time of :func:`time.monotonic` at which those under way are given up [s]."""


def insert(plan: Plan, stages: Sequence[Path], out: Path, tell: Callable[[str], None]) -> None:
    """Drive up all patients and write ``NAME/PATIENT.npz`` of each: ``steps`` (T, F) by ``FIELDS``, and ``about``.

    The insertion of a patient is that of the world that got furthest, see :class:`.record.Diary`. Its file
    is written when it ends, and every 20 simulated seconds before. Those that ran out of computing time go on with the
    next call for the same folder; those that have ended are left as they are.

    Args:
        plan: What drives, and how long.
        stages: Stages of the patients.
        out: Folder.
        tell: Called with a line about all of them every 10 simulated seconds.
    """
    stages = [stage for stage in stages if not _ended(out / plan.name / f"{stage.parent.name}.npz")]
    if not stages:
        return
    scene = build(plan, stages)
    speed = plan.speed or (EXAMINER_SPEED if plan.examiner else SPEED)
    drive = Drive(scene, speed, plan.patience, plan.max_time, plan.seed)
    expert = drive.expert
    if not isinstance(expert, Diary):
        raise TypeError(f"The drive has a {type(expert).__name__}, expected one with a Diary.")
    for index, patient in enumerate(scene.colon.patients):
        resume(drive, expert, index, _paused(plan, patient.name, out))
    drive.run("cecum", _Reporter(plan, scene, expert, out, tell), settled=False)


class _Reporter:
    """Writes insertions as they go on and end, and tells of them; called in every control step of a drive."""

    def __init__(self, plan: Plan, scene: InteractiveScene, expert: Diary, out: Path, tell: Callable[[str], None]):
        self._plan, self._scene, self._expert, self._out, self._tell = plan, scene, expert, out, tell
        self._began, self._ended = time.monotonic(), set[int]()

    def __call__(self, drive: Drive) -> None:
        self._stop_late(drive)
        fresh = [k for k, route in enumerate(drive.routes) if not route.running and k not in self._ended]
        self._ended.update(fresh)
        count = round(drive.time / CONTROL_STEP)
        under_way = [k for k in range(len(drive.routes)) if k not in self._ended] if count % KEPT_EVERY == 0 else []
        self._keep(drive, sorted([*fresh, *under_way]))
        for k in fresh:
            route = drive.routes[k]
            self._tell(f"{self._plan.name}, {self._name(k)}: {route.arc:.2f} m, {route.failure or 'arrived'}")
        if count % 100 == 0:
            spent = time.monotonic() - self._began
            arcs = " ".join(f"{route.arc:.2f}" for route in drive.routes)
            self._tell(f"{self._plan.name}, {drive.time:.0f} s simulated in {spent:.0f} s, tips at [m] {arcs}")

    def _stop_late(self, drive: Drive) -> None:
        """Give up the insertions under way, to go on with another time, once the deadline is over."""
        if time.monotonic() <= self._plan.deadline:
            return
        for patient, route in enumerate(drive.routes):
            if route.running:
                route.problem, route.held_by = OUT_OF_TIME, what_holds(self._scene, drive.foremost[patient])
                pause(drive, self._expert, patient, _paused(self._plan, self._name(patient), self._out))

    def _keep(self, drive: Drive, patients: Sequence[int]) -> None:
        """Write the insertions of some patients as far as they are."""
        last = [self._expert.entry(drive.foremost[patient]) for patient in patients]
        for patient, steps in zip(patients, self._expert.histories(last) if patients else [], strict=True):
            _write(self._plan, drive, patient, steps, self._out)

    def _name(self, patient: int) -> str:
        return self._scene.colon.patients[patient].name


def build(plan: Plan, stages: Sequence[Path]) -> InteractiveScene:
    """Return the task's worlds, some for each patient, without a camera."""
    cfg = load_env_cfg(TASK, (COLONOSCOPE, *plan.overrides), plan.seed, device=plan.device)
    validate(cfg)
    cfg.resolve()
    colon = replace(cfg.scene.colon, usd_path=[str(stage) for stage in stages], num_patients=None)
    expert = RecordedExaminer if plan.examiner else RecordedPushExpert
    endoscope = replace(cfg.scene.endoscope, expert=expert)
    count = plan.worlds * len(stages)
    return InteractiveScene(InteractiveSceneCfg(num_envs=count, colon=colon, endoscope=endoscope), cfg.sim)


def _paused(plan: Plan, patient: str, out: Path) -> Path:
    """Return the file of an insertion that ran out of computing time."""
    return out / plan.name / "paused" / f"{patient}.npz"


def _ended(path: Path) -> bool:
    """Whether an insertion has come to its end."""
    if not path.is_file():
        return False
    with np.load(path) as file:
        about = json.loads(str(file["about"]))
    return bool(about["arrived"] or (about["problem"] and about["problem"] != OUT_OF_TIME))


def _write(plan: Plan, drive: Drive, patient: int, steps: np.ndarray, out: Path) -> None:
    """Write the file of one insertion."""
    route, name = drive.routes[patient], drive.scene.colon.patients[patient].name
    about: dict[str, Any] = {"patient": name, "name": plan.name, "overrides": plan.overrides, "worlds": plan.worlds}
    about |= {
        "seed": plan.seed,
        "speed": plan.speed,
        "bounds": route.bounds,
        "arrived": "cecum" in route.entries,
        "reached": route.arc,
    }
    about |= {"problem": route.problem, "held_by": route.held_by}
    about |= {"entries": {name: asdict(entry) for name, entry in route.entries.items()}, "fields": FIELDS}
    folder = out / plan.name
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f"{name}.part"
    with open(part, "wb") as file:
        np.savez_compressed(file, steps=steps.astype(np.float32), about=np.array(json.dumps(about)))
    part.replace(folder / f"{name}.npz")
