# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Force and depth of the scope's tip pressed into the wall.

An indenter with the tip's round end lies across a straight tube and is driven into the wall along its normal, at one
vertex of the shipped mesh and at the middle of one triangle. Depth counts from the first touch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from fidelity_checks.models import Tube, build, wall_measures
from fidelity_checks.table import Plot, Row, Run, check, relative

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
STRIDE, MOVE, WAIT, SAMPLE = 5.0e-4, 0.0125, 0.0125, 0.0125
"""Way of the indenter between two samples [m], and times of moving, of waiting, and over which the force is averaged
[s]. A contact that closes also damps by its stiffness times the physics step; a resting one does not."""
TOUCH = 0.05
"""Force at which the tip touches the wall [N]."""
PLACES = {"vertex": 0.0, "triangle": 1.0 / 3.0}
"""Where the tip meets the wall: distance from a vertex, in sectors around and in rings along."""
LOADS = {"paper": (5.0, 10.0, 15.0), "in_situ": (2.0, 4.0, 6.0)}
"""Forces whose depths are compared, by tissue preset [N]. At 6 N most of the indenter is in the dent of the soft
wall."""
DEPTHS = {"paper": 0.016, "in_situ": 0.030}
"""Way of the indenter beyond the undented wall [m]."""
PORCINE = (0.8, 2.4)
"""Indentation stiffness of porcine colon [N/mm], straight tip to bent tip (Johnson et al. 2019)."""


@dataclass(frozen=True)
class Curve:
    """Force over depth at each place; P places, S samples."""

    depth: np.ndarray
    """Depth from the first touch [m], shape (P, S)."""
    force: np.ndarray
    """[N], shape (P, S)."""

    def depth_at(self, load: float) -> np.ndarray:
        """Depth under a load at each place [m], shape (P,)."""
        return np.array([_crossing(x, f, load) for x, f in zip(self.depth, self.force, strict=True)])

    def force_at(self, depth: float) -> float:
        """Force at a depth, mean of the places [N]."""
        return float(np.mean([np.interp(depth, x, f) for x, f in zip(self.depth, self.force, strict=True)]))


def _crossing(depth: np.ndarray, force: np.ndarray, load: float) -> float:
    """Depth at which the force first reaches the load; not a number if it never does."""
    above = np.flatnonzero(force >= load)
    if len(above) == 0 or above[0] == 0:
        return math.nan
    k = above[0]
    share = (load - force[k - 1]) / (force[k] - force[k - 1])
    return float(depth[k - 1] + share * (depth[k] - depth[k - 1]))


def indent(run: Run, tube: Tube, material: str, **cfg: Any) -> Curve:
    """Drive the indenter into a tube's wall, one world a place."""
    import torch

    sim = build(run, indenter(), tube, len(PLACES), {"material": material}, **cfg)
    data, measures = sim.endoscope.data, wall_measures()
    shares = torch.tensor(list(PLACES.values()), device=sim.device)
    angle = shares * 2.0 * math.pi / measures.sectors
    across = torch.stack([angle.cos(), angle.sin(), 0.0 * angle], dim=1)
    middle = TUBE.length / 2.0 // measures.spacing * measures.spacing + shares * measures.spacing
    start = (measures.radius - 0.5 * LENGTH - 2.0e-3) * across
    start[:, 2] = middle
    data.joint_pos[:, :3] = start
    data.joint_pos[:, 3:] = torch.stack(
        [-(angle / 2).sin(), (angle / 2).cos(), (angle / 2).sin(), (angle / 2).cos()], 1
    )
    data.joint_pos[:, 3:] *= math.sqrt(0.5)
    sim.contact.ring.fill_(-1)
    sim.forward()
    way, force = [], []
    for _ in range(round((DEPTHS[material] + 2.0e-3) / STRIDE)):
        data.joint_vel[:, :3] = STRIDE / MOVE * across
        sim.step(round(MOVE / sim.physics_dt))
        data.joint_vel.zero_()
        sim.step(round(WAIT / sim.physics_dt))
        sim.step(round(SAMPLE / sim.physics_dt))
        way.append(((data.body_pos_w[:, 0] - start) * across).sum(dim=1).cpu().numpy())
        force.append(-(data.wall_force_w[:, 0] * across).sum(dim=1).cpu().numpy())
    depth, forces = np.array(way).T, np.array(force).T
    touch = [_crossing(x, f, TOUCH) for x, f in zip(depth, forces, strict=True)]
    return Curve(depth - np.array(touch)[:, None], forces)


def indenter() -> Any:
    """A lone link with the radius of the colonoscope's tip."""
    from dataclasses import replace

    from arcgym.assets.endoscope_spec import capsule_spec

    values = {"link_radius": RADIUS, "link_length": LENGTH, "link_mass": HEAVY}
    return replace(capsule_spec(), **{name: np.array([value]) for name, value in values.items()})


def converged() -> dict[str, Any]:
    """Small steps, eight sweeps, a contact ten times as stiff, and room for the contacts of a finer mesh.

    With steps of 1/1920 s the fine ``in_situ`` wall blows up under 5 N.
    """
    from arcgym.sim import WallSolverCfg
    from arcgym.sim.simulation_cfg import ContactCfg

    return {
        "dt": 1.0 / 3840.0,
        "wall": WallSolverCfg(iterations=8),
        "contact": ContactCfg(stiffness=10.0 * ContactCfg().stiffness, capacity=192),
    }


def indentation(run: Run, material: str) -> list[Row]:
    """Depth of the tip under a load, mean of the places, against a finer mesh with a stiffer contact.

    The row is of the load with the largest error; all errors go into the note.
    """
    ours, limit = indent(run, TUBE, material), indent(run, REFINED, material, **converged())
    plot = Plot(f"indentation_{material}", "depth from first touch [mm]", "force [N]")
    top = LOADS[material][-1]
    for k, place in enumerate(PLACES):
        plot.points.append((f"shipped, at a {place}", *_shown(ours, k, top)))
        plot.lines.append((f"finer, at a {place}", *_shown(limit, k, top)))
    line = np.array([0.0, top / PORCINE[0]])
    plot.bands.append(("porcine colon (Johnson 2019)", line, PORCINE[0] * line, PORCINE[1] * line))
    plot.y_limit = 1.1 * top
    run.plots.append(plot)
    name = f"indentation_{material}"
    rows = []
    for load in LOADS[material]:
        value, reference = ours.depth_at(load), limit.depth_at(load)
        rows.append(relative(name, float(value.mean()), float(reference.mean()), 0.10, "m"))
    errors = ", ".join(f"{row.error:+.1%} at {load:g} N" for row, load in zip(rows, LOADS[material], strict=True))
    stiffness = 1.0e-3 * top / float(ours.depth_at(top).mean())
    worst = max(rows, key=lambda row: abs(row.error) if math.isfinite(row.error) else math.inf)
    deep = float(limit.depth_at(top).mean())
    note = f"{errors}; force at the reference's depth under {top:g} N {ours.force_at(deep) / top - 1.0:+.1%}; "
    note += f"{stiffness:.2f} N/mm at {top:g} N, porcine {PORCINE[0]} to {PORCINE[1]}"
    return [relative(name, worst.value, worst.reference, 0.10, "m", note)]


def _shown(curve: Curve, place: int, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Depth [mm] and force [N] from the first touch up to a load."""
    shown = (curve.depth[place] >= 0.0) & (curve.force[place] <= 1.1 * top)
    return 1.0e3 * curve.depth[place][shown], curve.force[place][shown]


for _material in LOADS:
    check(f"indentation_{_material}")(partial(indentation, material=_material))
