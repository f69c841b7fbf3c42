# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gas in a straight tube of soft wall: what pressure there is, how far the tube widens, when it collapses."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from arcgym.assets import GasCfg
from arcgym.assets.gas_cfg import MMHG
from arcgym.benchmarks.fidelity.models import build, shaft_spec
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import FREE, Tube
from arcgym.sim.wall.lumen_gas import lids

TUBE = Tube(0.45)
"""The tube; its rings and sectors are the shipped sigmoid's."""
IMAGED = 20.0 * MMHG
"""Pressure at which it is at rest [Pa]."""
BLOWN = 1.0e-5
"""Gas blown in, at the pressure of the room [m^3]: 10 ml."""
SUCKED = 2.0e-6
"""Flow out of the tube that is to collapse, at the pressure of the room [m^3/s]."""
DENT = 0.005
"""Share by which the tube is pressed oval before: a perfect one stays round."""
SHRUNK = 0.98
"""Share of its volume at which the collapsing tube's pressure is read: it has just folded."""


def filled_tube(run: Run, **gas: Any) -> Any:
    """Return a soft tube held at its ends alone, without a leak."""
    cfg = GasCfg(enabled=True, leak_conductance=0.0, **gas)
    return build(run, shaft_spec(3), TUBE, colon={"material": "in_situ", "anchor_stiffness": FREE, "gas": cfg})


def blow(sim: Any, flow: float, seconds: float) -> None:
    """Let gas flow in, or out below zero [m^3/s at the pressure of the room]."""
    sim.colon.set_gas_flow(torch.full((sim.num_envs,), flow, device=sim.device))
    sim.step(round(seconds / sim.physics_dt))


def wall_points(sim: Any) -> np.ndarray:
    """Return the wall of the only world [m], shape (V, 3)."""
    return sim.colon.data.nodal_pos_w[0].cpu().numpy().astype(float)


def middle_radius(sim: Any) -> float:
    """Return the mean radius of the ring half way [m]."""
    ring = sim.colon.wall.ring
    return float(np.linalg.norm(wall_points(sim)[ring == ring.max() // 2, :2], axis=1).mean())


def enclosed(sim: Any) -> float:
    """Return the volume inside the wall [m^3], by the divergence theorem in numpy."""
    faces = sim.colon.wall.triangles
    corners = wall_points(sim)[np.concatenate([faces, lids(faces)])]
    return float(np.linalg.det(corners).sum() / 6.0)


def inflation(run: Run) -> list[Row]:
    """Blow a known volume in, and compare pressure and radius with the ideal gas and the thin-walled tube.

    The reference of the pressure takes the volume that numpy measures on the widened wall; that of the radius is
    dr = p r^2 (1 - nu^2) / (E t), plane strain since the ends are held.
    """
    sim = filled_tube(run)
    ambient = sim.colon.cfg.gas.ambient_pressure
    before, radius = enclosed(sim), middle_radius(sim)
    blow(sim, BLOWN, 1.0)
    blow(sim, 0.0, 2.0)
    rise = sim.colon.data.lumen_pressure.item() - IMAGED
    ideal = ((ambient + IMAGED) * before + ambient * BLOWN) / enclosed(sim) - ambient - IMAGED
    modulus, ratio = sim.colon.elasticity()
    thin = rise * radius**2 * (1.0 - ratio**2) / (modulus * sim.colon.thickness)
    wider = middle_radius(sim) - radius
    note = f"{BLOWN * 1e6:g} ml into {before * 1e6:.0f} ml, in_situ"
    return [
        relative("gas_pressure", rise, ideal, 0.01, "Pa", note),
        relative("gas_radius", 1.0e3 * wider, 1.0e3 * thin, 0.10, "mm", "thin-walled tube in plane strain"),
    ]


def collapse(run: Run) -> list[Row]:
    """Suck a tube empty that has no tension at rest, and compare the pressure at which it folds with that of a ring.

    p = E t^3 / (4 (1 - nu^2) R^3) (Timoshenko and Gere, Theory of Elastic Stability, section 7.5).
    """
    sim = filled_tube(run, imaging_pressure=IMAGED, abdominal_pressure=IMAGED)
    whole, radius = enclosed(sim), middle_radius(sim)
    moving = torch.tensor(sim.colon.mobile(), device=sim.device)
    sim.colon.data.nodal_pos_w[0, moving, 0] *= 1.0 - DENT
    sim.colon.data.nodal_pos_w[0, moving, 1] *= 1.0 + DENT
    for _ in range(600):
        blow(sim, -SUCKED, 0.1)
        if enclosed(sim) < SHRUNK * whole:
            break
    modulus, ratio = sim.colon.elasticity()
    ring = modulus * sim.colon.thickness**3 / (4.0 * (1.0 - ratio**2) * radius**3)
    below = IMAGED - sim.colon.data.lumen_pressure.item()
    return [relative("gas_collapse", below, ring, 0.20, "Pa", f"at {SHRUNK:.0%} of the volume, in_situ; a long ring")]
