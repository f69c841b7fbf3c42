# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushing the shipped colonoscope through a bend that is tighter than the lumen is wide, against a converged run."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.folded_tube import folded_tube, write_folded
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.pushes import CONTROL_STEP, SPEED, converged
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute, relative

SECTION = 0.10
"""Length of the bending section, which is steered along the bend [m]."""
PASSED = 0.12
"""How far beyond the bend the tip is at the end [m]: the bending section has passed it."""


def folded(run: Run, material: str) -> list[Row]:
    """Compare the mean push once the tip is in the bend, and the mean distance of the tips from then on."""
    tube, name = folded_tube(), f"folded_{material}"
    ours, limit = _push(run, material), _push(run, material, **converged())
    late = ours[:, 0] > tube.bend_start
    apart = np.linalg.norm(ours[late, 2:] - limit[late, 2:], axis=1)
    plot = Plot(f"{name}_force", "inserted length [m]", "push on the base [N]")
    plot.lines.append(("converged", limit[:, 0], limit[:, 1]))
    plot.points.append(("shipped settings", ours[:, 0], ours[:, 1]))
    run.plots.append(plot)
    note = f"on average; {1.0e3 * apart.max():.1f} mm at most"
    return [
        relative(f"{name}_force", float(ours[late, 1].mean()), float(limit[late, 1].mean()), 0.10, "N"),
        absolute(f"{name}_tip", float(apart.mean()), 0.0, 0.002, "m", note),
    ]


def _push(run: Run, material: str, **cfg: Any) -> np.ndarray:
    """Push through the bend; return inserted length [m], push [N] and place of the tip [m] by control step, (S, 5)."""
    tube = folded_tube()
    end = tube.bend_start + tube.bend * tube.bend_radius
    path = str(write_folded(run.folder))
    sim = build(run, PROXIMAL_CFG, colon={"usd_path": path, "material": material}, **cfg)
    scope, steps, samples = sim.endoscope, round(CONTROL_STEP / sim.physics_dt), []
    still = torch.zeros(1, device=sim.device)
    scope.set_insertion_command(still + SPEED, still)
    for _ in range(round((end + PASSED - scope.rest_insertion) / (SPEED * CONTROL_STEP))):
        inserted = scope.data.inserted_length[0].item()
        ends = np.array([inserted, inserted - SECTION]) - tube.bend_start
        turned = np.clip(ends / tube.bend_radius, 0.0, tube.bend)
        scope.set_bending_command(still - float(turned[0] - turned[1]), still)
        sim.step(steps)
        data = scope.data
        samples.append([data.inserted_length.item(), data.base_force.item(), *data.tip_pos_w[0].tolist()])
    return np.array(samples)
