# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Wall that stiffens, is thinner where it is wide, and relaxes: a tube of the shipped mesh against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import FREE, Tube

MODULUS = 95.0e3
"""Young's modulus of the inflated tubes [Pa], that of ``clinical``."""
STIFFENING = 1.5
"""Factor of stiffening of the inflated tubes."""
PRESSURES = (500.0, 1500.0, 3000.0)
"""Pressures beyond that of the imaging [Pa]; the last widens the tube by a quarter."""
FLOW = 1.0e-4
"""Gas blown in until then [m^3/s]: 6 l/min."""
LONGEST = 500
"""Twelves of steps that it may take."""
HELD = 1.15
"""Stretch that the relaxing tube is held at."""
WAIT = (1.0, 10.0)
"""Times after which its pull is measured [s]."""


def hoop(run: Run, radius: float, name: str = "stiffening_hoop", thinned: bool = False) -> list[Row]:
    """Inflate a tube that is held at both ends, and compare the pressure with the law's at the width that it has.

    Args:
        run: Device and folder.
        radius: Radius of the lumen [m].
        name: Name of the row.
        thinned: Whether the wall's thickness goes by the diameter.
    """
    points = [_inflated(run, radius, thinned, pressure) for pressure in PRESSURES]
    stretch, pressure, exact = np.array(points).T
    plot = Plot(name, "circumference over that at rest", "pressure beyond that of the imaging [kPa]")
    plot.lines.append(("closed form", stretch, 1.0e-3 * exact))
    plot.points.append(("shipped mesh", stretch, 1.0e-3 * pressure))
    run.plots.append(plot)
    rows = [relative(name, float(p), float(e), 0.05, "Pa") for p, e in zip(pressure, exact, strict=True)]
    worst = max(rows, key=lambda row: abs(row.error))
    note = ", ".join(f"{row.error:+.1%} at {s - 1.0:.0%}" for row, s in zip(rows, stretch, strict=True))
    return [relative(name, worst.value, worst.reference, 0.05, "Pa", note)]


def _inflated(run: Run, radius: float, thinned: bool, pressure: float) -> tuple[float, float, float]:
    """Return stretch, pressure and that of the closed form [Pa] half way along an inflated tube."""
    import torch

    from arcgym.assets import CAPSULE_CFG, GasCfg, WallLawCfg

    gas = GasCfg(enabled=True, leak_conductance=0.0)
    law = WallLawCfg(stiffening=STIFFENING, thickness_by_diameter=thinned)
    colon = {"material": "in_situ", "youngs_modulus": MODULUS, "anchor_stiffness": FREE, "gas": gas, "wall_law": law}
    sim = build(run, CAPSULE_CFG, Tube(0.30, radius=radius), colon=colon)
    sim.colon.set_gas_flow(torch.full((1,), FLOW, device=sim.device))
    for _ in range(LONGEST):
        if sim.colon.data.lumen_pressure.item() >= gas.imaging_pressure + pressure:
            break
        sim.step(12)
    sim.colon.set_gas_flow(torch.zeros(1, device=sim.device))
    settle(sim, tolerance=1.0e-5)
    wall = sim.colon.wall
    here = wall.ring == int(wall.ring.max()) // 2
    rest = np.linalg.norm(wall.points[here, :2].astype(float), axis=1).mean()
    now = sim.colon.data.nodal_pos_w[0, :, :2].cpu().numpy()[here]
    stretch = float(np.linalg.norm(now, axis=1).mean() / rest)
    thickness = law.thickness_times_diameter / (2.0 * rest) if thinned else sim.colon.thickness
    middle = rest * math.cos(math.pi / here.sum())  # of the polygon's sides, on which the pressure acts
    beyond = sim.colon.data.lumen_pressure.item() - gas.imaging_pressure
    return stretch, beyond, thickness / middle * hoop_stress(stretch, *sim.colon.elasticity())


def hoop_stress(stretch: float, youngs_modulus: float, poissons_ratio: float) -> float:
    """Return the second Piola-Kirchhoff stress around a tube that does not get longer [Pa].

    mu (1 + b (I - 2)^2) + (lambda ln J - mu) / stretch^2 with J = stretch and I - 2 = stretch^2 - 1, mu and lambda of
    plane stress. Pressure times radius is stress times stretch times thickness, and the radius grows by the stretch.
    """
    mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    lame = youngs_modulus * poissons_ratio / (1.0 - poissons_ratio**2)
    excess = stretch**2 - 1.0
    return mu * (1.0 + STIFFENING * excess**2) + (lame * math.log(stretch) - mu) / stretch**2


def relaxation(run: Run) -> list[Row]:
    """Hold a tube stretched lengthwise, and compare the fading of its pull with the series."""
    import torch

    from arcgym.assets import CAPSULE_CFG, WallLawCfg

    law = WallLawCfg(relaxation=True)
    colon = {"material": "in_situ", "anchor_stiffness": FREE, "wall_law": law}
    sim = build(run, CAPSULE_CFG, Tube(0.10), colon=colon)
    sim.colon.data.nodal_pos_w[..., 2] *= HELD
    sim.colon.write_rigid_to_sim(torch.ones(1, dtype=torch.bool))
    first, rows, elapsed = axial_pull(sim), [], 0.0
    for name, wait in zip(("relaxation_quick", "relaxation_slow"), WAIT, strict=True):
        sim.step(round((wait - elapsed) / sim.physics_dt))
        elapsed = wait
        terms = zip(law.relaxing_share, law.relaxing_time, strict=True)
        series = 1.0 - sum(share * (1.0 - math.exp(-wait / time)) for share, time in terms)
        rows.append(
            relative(name, axial_pull(sim) / first, series, 0.02, note=f"of the pull at once, after {wait:g} s")
        )
    return rows


def axial_pull(sim: Any) -> float:
    """Return the force along Z between two rings half way along a tube [N]."""
    sim.wall.elements.measure(sim.nodal_pos, sim.wall.tissue)
    shell, ring = sim.wall.elements.data.shell, sim.colon.wall.ring
    corners = ring[shell.triangles.numpy()]
    lower = int(ring.max()) // 2
    across = (corners.min(axis=1) == lower) & (corners.max(axis=1) == lower + 1)
    force = shell.corner_force.numpy()[:, 0, 2].reshape(-1, 3)
    return float(-(force * (corners == lower + 1))[across].sum())
