# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Depth of the tip in the wall under a load, against a finer mesh with a stiffer contact."""

from __future__ import annotations

import math

import numpy as np

from arcgym.assets import WallLawCfg
from arcgym.benchmarks.fidelity.indenter import PLACES, REFINED, TUBE, Curve, converged, indent, indent_both
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.sim import ContactCfg, WallSolverCfg

LOADS = {"paper": (5.0, 10.0, 15.0), "in_situ": (2.0, 4.0, 6.0)}
"""Forces whose depths are compared, by tissue preset [N]. At 6 N most of the indenter is in the dent of the soft
wall."""
LIGHT = (0.1, 0.2, 0.5)
"""Forces under which a coarse wall is too stiff the most [N]: what a tip that is steered bears in soft tissue."""
QUIETER = {"dt": 1.0 / 1920.0, "wall": WallSolverCfg(iterations=4)}
"""What is enough of :func:`~.indenter.converged` under them, in a quarter of the time."""
BEYOND = 1.3
"""Share of the largest of them up to which curves go: the shipped mesh's force where the finer one bears that load."""
PORCINE = (0.8, 2.4)
"""Indentation stiffness of porcine colon [N/mm], straight tip to bent tip (Johnson et al. 2019)."""


def indentation(run: Run, material: str) -> list[Row]:
    """Measure the depth of the tip under a load, mean of the places, against a finer mesh.

    The row is of the load with the largest error; all errors go into the note.
    """
    ours, limit = indent_both(run, material, BEYOND * LOADS[material][-1])
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


def light(run: Run) -> list[Row]:
    """Measure the light dent of a wall that strains by cells and whose faces lie on its surface on average.

    Depths count from the round tube, so that faces which cut its bend count, and a contact that gives less than the
    shipped one does not make up for them. The row is of the load with the largest error; the plain wall's go into the
    note.
    """
    stiff = ContactCfg(tissue_share=0.0)
    mended = WallLawCfg(cell_strain=True, mean_surface=True)
    curves = {
        name: indent(run, TUBE, "in_situ", top=LIGHT[-1], law=law, touched=False, contact=stiff)
        for name, law in {"plain": WallLawCfg(), "mended": mended}.items()
    }
    limit = indent(run, REFINED, "in_situ", top=LIGHT[-1], touched=False, **(converged() | QUIETER))
    reference = [float(limit.depth_at(load).mean()) for load in LIGHT]
    rows = {
        name: [
            relative("light_dent", float(curve.depth_at(load).mean()), deep, 0.10, "m")
            for load, deep in zip(LIGHT, reference, strict=True)
        ]
        for name, curve in curves.items()
    }
    notes = [f"{name} " + ", ".join(f"{row.error:+.1%}" for row in own) for name, own in rows.items()]
    worst = max(rows["mended"], key=lambda row: abs(row.error))
    note = "; ".join(notes) + f" under {', '.join(f'{load:g}' for load in LIGHT)} N"
    return [relative("light_dent", worst.value, worst.reference, 0.10, "m", note)]


def _shown(curve: Curve, place: int, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the depth [mm] and force [N] from the first touch up to a load."""
    shown = (curve.depth[place] >= 0.0) & (curve.force[place] <= 1.1 * top)
    return 1.0e3 * curve.depth[place][shown], curve.force[place][shown]
