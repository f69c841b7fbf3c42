# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Force and depth of the scope's tip pressed into the wall.

An indenter with the tip's round end lies across a straight tube and is driven into the wall along its normal, at one
vertex of the shipped mesh and at the middle of one triangle. Depth counts from the first touch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from arcgym.assets import WallLawCfg
from arcgym.assets.endoscope_spec import EndoscopeSpec, capsule_spec
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.processes import in_processes
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.tubes import Tube, wall_measures
from arcgym.sim import WallSolverCfg
from arcgym.sim.simulation_cfg import ContactCfg

TUBE = Tube(0.20)
"""Tube with the shipped mesh and anchors of the sigmoid."""
REFINED = Tube(0.20, refine=3)
"""The same with a third of the distance of rings and three times the sectors: under 15 N ``paper`` dents by 8.83 mm
with twice, 8.91 mm with three and 8.96 mm with four times as many."""
RADIUS = 0.0066
"""Radius of the tip [m]."""
LENGTH = 0.03
"""Length of the indenter [m]; it fits into the tube."""
HEAVY = 1.0e6
"""Mass of the indenter [kg]: it keeps its speed."""
STRIDE, MOVE, WAIT, SAMPLE = 5.0e-4, 0.0125, 0.1, 0.0125
"""Way of the indenter between two samples [m], and times of moving, of waiting, and over which the force is averaged
[s]. A contact that closes also damps by its stiffness times the physics step, and the soft wall is slow: 12.5 ms after
a move an ``in_situ`` wall is dented by 12 % too little under 0.5 N, after 50 ms by 1 % too much."""
TOUCH = 0.05
"""Force at which the tip touches the wall [N]."""
PLACES = {"vertex": 0.0, "triangle": 1.0 / 3.0}
"""Where the tip meets the wall: distance from a vertex, in sectors around and in rings along."""
DEPTHS = {"paper": 0.016, "in_situ": 0.030}
"""Way of the indenter beyond the undented wall [m]."""


AHEAD = 2.0e-3
"""Distance of the indenter's end from the wall where it begins [m]."""


@dataclass(frozen=True)
class Curve:
    """Force over depth at each place; P places, S samples."""

    depth: np.ndarray
    """Depth from the first touch [m], shape (P, S)."""
    force: np.ndarray
    """[N], shape (P, S)."""

    def depth_at(self, load: float) -> np.ndarray:
        """Return the depth under a load at each place [m], shape (P,)."""
        return np.array([_crossing(x, f, load) for x, f in zip(self.depth, self.force, strict=True)])

    def force_at(self, depth: float) -> float:
        """Return the force at a depth, mean of the places [N]."""
        known = [(x[np.isfinite(f)], f[np.isfinite(f)]) for x, f in zip(self.depth, self.force, strict=True)]
        return float(np.mean([np.interp(depth, x, f) for x, f in known]))


def _crossing(depth: np.ndarray, force: np.ndarray, load: float) -> float:
    """Return the depth at which the force first reaches the load; not a number if it never does."""
    above = np.flatnonzero(force >= load)
    if len(above) == 0 or above[0] == 0:
        return math.nan
    k = above[0]
    share = (load - force[k - 1]) / (force[k] - force[k - 1])
    return float(depth[k - 1] + share * (depth[k] - depth[k - 1]))


def indent(
    run: Run,
    tube: Tube,
    material: str,
    thickness: float | None = None,
    places: Sequence[str] = tuple(PLACES),
    top: float = math.inf,
    law: WallLawCfg | None = None,
    touched: bool = True,
    **cfg: Any,
) -> Curve:
    """Drive the indenter into a tube's wall, one world a place.

    Args:
        run: Device and folder.
        tube: The tube.
        material: Its tissue preset.
        thickness: Thickness of its wall [m]; the tissue's by default.
        places: Which of :data:`PLACES`.
        top: Force at which it ends, once every place has reached it [N].
        law: Law of the wall; the plain one if None.
        touched: Whether depths count from the first touch; else from where the round tube through the mesh's vertices
            would be touched.
        cfg: Changes of ``SimulationCfg``.
    """
    colon = {"material": material, "wall_thickness": thickness, "wall_law": law or WallLawCfg()}
    sim = build(run, indenter(), tube, len(places), colon, **cfg)
    data, measures = sim.endoscope.data, wall_measures()
    shares = torch.tensor([PLACES[place] for place in places], device=sim.device)
    angle = shares * 2.0 * math.pi / measures.sectors
    across = torch.stack([angle.cos(), angle.sin(), 0.0 * angle], dim=1)
    middle = (round(0.5 * tube.length / tube.spacing()) + shares) * tube.spacing()
    radius = measures.radius if tube.radius is None else tube.radius
    start = (radius - 0.5 * LENGTH - AHEAD) * across
    start[:, 2] = middle
    data.joint_pos[:, :3] = start
    data.joint_pos[:, 3:] = torch.stack(
        [-(angle / 2).sin(), (angle / 2).cos(), (angle / 2).sin(), (angle / 2).cos()], 1
    )
    data.joint_pos[:, 3:] *= math.sqrt(0.5)
    sim.contact.ring.fill_(-1)
    sim.forward()
    way, force = [], []
    for _ in range(round((DEPTHS[material] + AHEAD) / STRIDE)):
        data.joint_vel[:, :3] = STRIDE / MOVE * across
        sim.step(round(MOVE / sim.physics_dt))
        data.joint_vel.zero_()
        sim.step(round(WAIT / sim.physics_dt))
        sim.step(round(SAMPLE / sim.physics_dt))
        way.append(((data.body_pos_w[:, 0] - start) * across).sum(dim=1).cpu().numpy())
        force.append(-(data.link_force_w[:, 0] * across).sum(dim=1).cpu().numpy())
        if (force[-1] > top).all():
            break
    depth, forces = np.array(way).T, np.array(force).T
    skin = AHEAD - sim.cfg.contact.wall_radius
    touch = [_crossing(x, f, TOUCH) if touched else skin for x, f in zip(depth, forces, strict=True)]
    return Curve(depth - np.array(touch)[:, None], forces)


def indent_both(run: Run, material: str, top: float) -> tuple[Curve, Curve]:
    """Return the curves of the shipped mesh and of the refined one up to a force [N]; on a CPU each place is a process.

    Args:
        run: Device and folder.
        material: Tissue preset.
        top: Force at which a curve ends [N].
    """
    alone = [tuple(PLACES)] if run.device.startswith("cuda") else [(place,) for place in PLACES]
    tasks = [(run.device, run.folder, fine, material, places, top) for fine in (True, False) for places in alone]
    curves = in_processes(indent_places, tasks)
    limit, ours = curves[: len(alone)], curves[len(alone) :]
    return join_curves(ours), join_curves(limit)


def indent_places(device: str, folder: Path, fine: bool, material: str, places: tuple[str, ...], top: float) -> Curve:
    """Return the curves at some places, of the refined mesh or of the shipped one; what a process of its own does."""
    torch.set_num_threads(1)
    own = folder / f"indent_{'fine' if fine else 'shipped'}_{'_'.join(places)}"
    own.mkdir(parents=True, exist_ok=True)
    tube, cfg = (REFINED, converged()) if fine else (TUBE, {})
    return indent(Run(device, own), tube, material, places=places, top=top, **cfg)


def join_curves(curves: Sequence[Curve]) -> Curve:
    """Return the curves of all places, none a number where another place went on."""
    longest = max(curve.force.shape[1] for curve in curves)

    def fill(values: np.ndarray) -> np.ndarray:
        return np.pad(values, ((0, 0), (0, longest - values.shape[1])), constant_values=math.nan)

    return Curve(np.concatenate([fill(c.depth) for c in curves]), np.concatenate([fill(c.force) for c in curves]))


def indenter() -> EndoscopeSpec:
    """Return a lone link with the radius of the colonoscope's tip."""
    return replace(
        capsule_spec(),
        link_radius=np.array([RADIUS]),
        link_length=np.array([LENGTH]),
        link_mass=np.array([HEAVY]),
    )


def converged() -> dict[str, Any]:
    """Return small steps, eight sweeps, a contact ten times as stiff on any tissue, and room for those of a finer mesh.

    With steps of 1/1920 s the fine ``in_situ`` wall blows up under 5 N.
    """
    return {
        "dt": 1.0 / 3840.0,
        "wall": WallSolverCfg(iterations=8),
        "contact": ContactCfg(
            stiffness=10.0 * ContactCfg().stiffness, tissue_share=0.0, capacity=192, patch_capacity=96
        ),
    }
