# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripted insertions through the sigmoid of colon 1, shipped and with one numerical setting changed.

On a GPU all insertions of a case run at once, a world each. On a CPU every fourth of them runs, in a process of its
own, as many at a time as there are cores.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.assets.endoscope_spec import EndoscopeSpec, magnetic_spec, proximal_spec
from arcgym.benchmarks.fidelity.processes import in_processes
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.smooth_colon import write_smooth

SPEED = {"magnetic": 0.04, "proximal": 0.04}
"""Speed of the experts [m/s]."""
INSERTIONS = {"magnetic": 13, "proximal": 29}
"""Insertions over which the figures of one case are means on a GPU: single ones differ by which fold the tip slips past
when."""
CPU_STRIDE = 4
"""A CPU makes every so many of them: 4 and 8, of the same speeds as the whole set's."""
SPREAD = 0.1
"""Share by which the slowest and the fastest of them are off the speed."""
CONTROL_STEP = 0.1
"""Time between two decisions of the expert, over which forces are averaged [s]."""
END = ("sigmoid", 0.05)
"""Segment of the colon, and the way beyond its end at which an insertion ends [m]: its last bend is behind the tip."""
FAR_END = ("splenic", 0.0)
"""Segment and way beyond its end [m] at which the insertions end that go on. Their figures have names with ``far_``;
no row judges them."""
FAR = "far_"
"""How the names of these figures begin."""
MARGIN = 0.1
"""Length of colon beyond an insertion's end that moves [m]; the rest would only cost time."""
FINE_SWEEPS = 2
"""Sweeps a step of the finer wall. With one, as shipped, it trembles in ``paper`` by 0.04 m/s with no scope near; the
shipped wall is calm."""
LONGEST = 60.0
"""Simulated time after which an insertion ends that has not come through [s]."""
HIGH = 5.0
"""Force of which the time above it is counted [N]."""
NEAR = 0.1
"""Share of it within which a force counts as near it."""
HALT = 0.002
"""Way that a tip makes in no less than a halt [m]."""
SPECS = {"magnetic": magnetic_spec, "proximal": proximal_spec}
"""Robots."""
STEERING: dict[str, dict[str, float]] = {
    "magnetic": {},
    "proximal": {"look": 0.015, "gain": 0.15, "patience": 25.0, "least_pace": 0.15},
}
"""Settings of their experts. Those of the pushed scope were chosen by a rule, see docs/force_studies.md."""
SETTINGS = {
    "contact_double": "contact stiffness times 2",
    "contact_half": "contact stiffness over 2",
    "dt_half": "time step over 2",
    "damping_fifth": "hinge damping times 0.2",
    "links_half": "links half as long",
    "wall_half": "rings and sectors of the wall half as far apart, on the smooth surface through its vertices",
    "noise": "speed times 1.0025",
}
"""Settings changed, one at a time."""
METRICS = ("p95_tip_force", "mean_window_force", "peak_window_force", "time_above_5N", "mean_base_force")
"""Figures of an insertion [N and s]."""


@dataclass(frozen=True)
class Insertion:
    """One insertion."""

    robot: str
    """``magnetic``, pulled at its tip, or ``proximal``, pushed at its base."""
    material: str
    """Tissue preset."""
    setting: str = ""
    """One of :data:`SETTINGS`; empty for the shipped ones."""
    colon: str | None = None
    """Stage of the colon; colon 1 if None."""
    far: bool = False
    """Whether it goes on to :data:`FAR_END`."""
    friction: float | None = None
    """Coulomb coefficient; the shipped one if None."""

    @property
    def scene(self) -> str:
        """Name of what is compared with the same scene under other settings."""
        colon = [] if self.colon is None else [Path(self.colon).parent.name]
        friction = [] if self.friction is None else [f"friction {self.friction:g}"]
        return ", ".join([self.robot, self.material, *colon, *friction])


SCENES = (
    Insertion("proximal", "paper"),
    Insertion("proximal", "in_situ", far=True),
    Insertion("proximal", "in_situ", friction=0.2),
    Insertion("magnetic", "paper"),
    Insertion("magnetic", "in_situ"),
)
"""Insertions with the shipped settings. The third is there for its time above 5 N, see docs/force_studies.md."""


def numbers_on(device: str, robot: str) -> range:
    """Return which insertions of a robot are made on a device: all on a GPU, every fourth on a CPU."""
    return range(0, INSERTIONS[robot], 1 if device.startswith("cuda") else CPU_STRIDE)


def insert_all(run: Run, cases: list[Insertion]) -> list[list[dict[str, float]]]:
    """Return the figures of every insertion of cases; those that the run has are not made again.

    Args:
        run: Device, folder and results.
        cases: The cases.
    """
    wanted = [(case, k) for case in cases for k in numbers_on(run.device, case.robot)]
    missing = [(case, k) for case, k in wanted if ("insertion", case, k) not in run.shared]
    for colon in {case.colon for case, _ in missing if case.setting == "wall_half"}:
        write_smooth(run.folder, refine=2, colon=colon)
    if run.device.startswith("cuda"):
        for case in dict.fromkeys(case for case, _ in missing):
            numbers = numbers_on(run.device, case.robot)
            keep_figures(run, case, numbers, insert(case, numbers, run.device, run.folder))
    else:
        tasks = [(case, (k,), run.device, run.folder) for case, k in missing]
        for (case, k), figures in zip(missing, in_processes(insert, tasks), strict=True):
            keep_figures(run, case, (k,), figures)
    return [[run.shared["insertion", case, k] for k in numbers_on(run.device, case.robot)] for case in cases]


def keep_figures(run: Run, case: Insertion, numbers: Sequence[int], figures: list[dict[str, float]]) -> None:
    """Keep the figures of insertions of a case among the run's results."""
    for number, one in zip(numbers, figures, strict=True):
        run.shared["insertion", case, number] = one


def mean_figures(figures: list[dict[str, float]]) -> dict[str, float]:
    """Return the means of the figures of insertions."""
    return {name: float(np.mean([one[name] for one in figures])) for name in figures[0]}


def insert(case: Insertion, numbers: Sequence[int], device: str, folder: Path) -> list[dict[str, float]]:
    """Drive a robot by its expert from the anus through the sigmoid, and return the figures of every insertion.

    Args:
        case: The case.
        numbers: Which of its insertions, from 0, each in a world of its own; they differ in their speed.
        device: Device of the simulation.
        folder: Folder for the stages.
    """
    return [figures_to_ends(case, samples) for samples in drive(case, numbers, device, folder)]


def drive(case: Insertion, numbers: Sequence[int], device: str, folder: Path) -> list[np.ndarray]:
    """Make insertions, one a world, and return what was measured until each was at its last end or time was up.

    Returns:
        For every insertion, by control step: force on the tip, largest force on a window, force of the drive [N], arc
        length of the tip from the end of the insertion on [m], shape (T, 4).
    """
    import torch

    from arcgym.experts import make_expert

    torch.set_num_threads(1)
    torch.manual_seed(0)
    scene = build_scene(case, device, folder, num_envs=len(numbers))
    pace = SPEED[case.robot] * (1.0025 if case.setting == "noise" else 1.0)
    paces = pace * np.linspace(1.0 - SPREAD, 1.0 + SPREAD, INSERTIONS[case.robot])[list(numbers)]
    expert = make_expert(scene, speed=torch.tensor(paces), **STEERING[case.robot])
    end, last = ends_of(case, scene.colon.stage)
    steps = round(CONTROL_STEP / scene.sim.physics_dt)
    samples = list[np.ndarray]()
    through = np.zeros(len(numbers), bool)
    with torch.inference_mode():
        while not through.all() and len(samples) * CONTROL_STEP < LONGEST:
            expert.act()
            scene.sim.step(steps)
            left = scene.endoscope.data.tip_arc_length.cpu().numpy().astype(float) - end
            samples.append(np.column_stack([read_forces(scene.sim, case.robot), left]))
            through |= left >= last - end
    return [cut(series, last - end) for series in np.array(samples).swapaxes(0, 1)]


def cut(series: np.ndarray, end: float = 0.0) -> np.ndarray:
    """Return what was measured until the tip first was so far beyond the end of the insertion [m], shape (T, 4)."""
    there = np.flatnonzero(series[:, 3] >= end)
    return series[: there[0] + 1] if len(there) else series


def figures_to_ends(case: Insertion, samples: np.ndarray) -> dict[str, float]:
    """Return the figures of an insertion to its end, and of the whole way if it goes on."""
    figures = figures_of(cut(samples))
    if case.far:
        figures |= {FAR + name: value for name, value in figures_of(samples).items()}
    return figures


def figures_of(samples: np.ndarray) -> dict[str, float]:
    """Return the figures of an insertion, and what a well-conditioned one is judged by.

    Args:
        samples: Force on the tip, largest force on a window and force of the drive by control step [N], and the tip's
            arc length from the end of the insertion on [m], shape (T, 4).
    """
    tip, window, drive, arc = samples.T
    values = (np.percentile(tip, 95), window.mean(), window.max(), CONTROL_STEP * np.sum(window > HIGH), drive.mean())
    return dict(zip(METRICS, map(float, values), strict=True)) | {
        "time": CONTROL_STEP * len(tip),
        "through": float(arc.max() >= 0.0),
        "peak_base_force": float(drive.max()),
        "standstill": CONTROL_STEP * longest_halt(arc),
        "time_near_5N": CONTROL_STEP * float(np.sum(np.abs(window - HIGH) < NEAR * HIGH)),
    }


def longest_halt(arc: np.ndarray) -> int:
    """Return the largest number of control steps in which the farthest that the tip was grows by less than HALT."""
    best = np.maximum.accumulate(arc)
    return max(k - int(np.searchsorted(best, best[k] - HALT, side="right")) for k in range(len(best)))


def read_forces(sim: Any, robot: str) -> np.ndarray:
    """Return the force on the tip, the largest on a window of scope, and the drive's, means over a step [N], (N, 3).

    The drive's is the push on the base, or the pull on the tip of a robot whose base is not driven.
    """
    import torch

    data = sim.endoscope.data
    drive = data.base_force.abs() if robot == "proximal" else data.tip_pull_force_w.norm(dim=1)
    return torch.stack([data.tip_force, data.window_force_norm.amax(dim=1), drive], dim=1).cpu().numpy().astype(float)


def ends_of(case: Insertion, colon: Any) -> tuple[float, float]:
    """Return the tip's arc lengths at the end of an insertion in a colon, and at the end of the whole way [m]."""
    ends = (END, FAR_END if case.far else END)
    end, last = (float(colon.segment_bounds()[segment][1]) + past for segment, past in ends)
    return end, last


def build_scene(case: Insertion, device: str, folder: Path, num_envs: int = 1) -> Any:
    """Return worlds with the robot at the anus of the case's colon."""
    from arcgym import assets
    from arcgym.anatomy import read_colon
    from arcgym.assets.endoscope_stage import write_endoscope
    from arcgym.assets.patient_files import find_stages
    from arcgym.scene import InteractiveSceneCfg
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.sim import SimulationCfg

    spec, setting = SPECS[case.robot](), case.setting
    endoscope = getattr(assets, f"{case.robot.upper()}_CFG")
    if setting == "links_half":
        spec = halved(spec)
    if setting == "damping_fifth":
        spec = replace(spec, damping_time=0.2 * spec.damping_time, armature_time=spec.armature_time / 0.2)
    path = write_endoscope(spec, folder / f"{case.robot}_{setting or 'shipped'}_{os.getpid()}.usda")
    colon = assets.ColonCfg(material=case.material)
    colon.usd_path = case.colon or colon.usd_path
    colon.mobile_until = ends_of(case, read_colon(find_stages(colon.usd_path)[0]))[1] + MARGIN
    sim = SimulationCfg(device=device)
    if setting == "wall_half":
        colon.usd_path = str(write_smooth(folder, refine=2, colon=case.colon))
        sim.wall = replace(sim.wall, iterations=FINE_SWEEPS)
    sim.dt *= 0.5 if setting == "dt_half" else 1.0
    factor = {"contact_double": 2.0, "contact_half": 0.5}.get(setting, 1.0)
    friction = sim.contact.friction if case.friction is None else case.friction
    stiffness, share = factor * sim.contact.stiffness, factor * sim.contact.tissue_share
    sim.contact = replace(sim.contact, stiffness=stiffness, tissue_share=share, friction=friction)
    if setting in ("links_half", "wall_half"):
        sim.contact = replace(sim.contact, capacity=2 * sim.contact.capacity, patch_capacity=48)
    scene = InteractiveSceneCfg(num_envs=num_envs, colon=colon, endoscope=replace(endoscope, usd_path=str(path)))
    return InteractiveScene(scene, sim)


def halved(spec: EndoscopeSpec) -> EndoscopeSpec:
    """Return a scope of the same shaft with every link cut in two but the base and the last.

    The last link carries the camera, and a magnet pulls at its middle: cut in two, it would be pulled elsewhere.
    """
    links = len(spec.link_length)
    parts = np.r_[1, np.full(links - 2, 2), 1]
    bent = max(0, 2 * spec.bending_links - 1)
    limit = _split_hinges(spec.hinge_limit)
    limit[: len(limit) - bent] *= 0.5
    limit[len(limit) - bent :] *= spec.bending_links / max(1, bent)
    return replace(
        spec,
        link_length=np.repeat(spec.link_length / parts, parts),
        link_radius=np.repeat(spec.link_radius, parts),
        link_mass=np.repeat(spec.link_mass / parts, parts),
        bending_rigidity=_split_hinges(spec.bending_rigidity),
        torsional_rigidity=_split_hinges(spec.torsional_rigidity),
        hinge_limit=limit,
        bending_links=bent,
    )


def _split_hinges(value: np.ndarray) -> np.ndarray:
    """Return rigidities or limits at the hinges of the halved chain: at a link's middle the harmonic mean of its ends'.

    A hinge stands for half of its two links, so that half of what a middle hinge stands for was each of theirs.
    """
    middle = 2.0 / (1.0 / value[:-1] + 1.0 / value[1:])
    out = np.repeat(value, 2, axis=0)[:-1]
    out[1::2] = middle
    return out
