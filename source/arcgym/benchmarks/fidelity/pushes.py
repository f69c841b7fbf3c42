# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushes of the shipped colonoscope through a tube or into the shipped colon."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch

from arcgym.assets import PROXIMAL_CFG
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.smooth_colon import write_smooth
from arcgym.benchmarks.fidelity.tubes import Tube
from arcgym.benchmarks.fidelity.volumes import volume_ratios
from arcgym.experts.expert_base import CONTROL_STEP
from arcgym.sim import WallSolverCfg

BEND = Tube(0.40, math.radians(100.0), 0.14, 0.05)
"""Tube with a bend of 100 degrees."""
STRAIGHT = Tube(0.40)
"""Tube without one."""
SPEED = 0.05
"""Speed of the base [m/s]."""
DEPTH = 0.30
"""Inserted length at the end of a push through a tube [m]."""
SIGMOID_DEPTH = 0.36
"""Inserted length at the end of a push into the colon [m]: the tip is in the S of the sigmoid."""
SIGMOID_MOBILE = 0.50
"""Arc length up to which the colon's wall moves in these pushes [m]; the rest would only cost time."""
DEEP, DEEP_MOBILE = 0.55, 0.80
"""The same for a push through the S until the scope, which nobody steers, stands still in its last bend [m]."""


@dataclass
class Trace:
    """A push and the rest after it, sampled every control step."""

    sim: Any
    """The simulation in its last state."""
    inserted: list[float] = field(default_factory=list)
    """Inserted length while pushing [m]."""
    force: list[float] = field(default_factory=list)
    """Push on the base [N]."""
    tip: list[np.ndarray] = field(default_factory=list)
    """Place of the tip [m]."""
    moved: list[float] = field(default_factory=list)
    """Largest displacement of the wall [m]."""
    volume: list[tuple[float, float]] = field(default_factory=list)
    """Smallest and largest volume ratio of the wall's elements."""

    def late(self, values: list[float]) -> float:
        """Return the mean over the second half of the push, when the tip is in the bend or beyond it."""
        return float(np.mean(values[len(values) // 2 :]))


def converged() -> dict[str, Any]:
    """Return settings near the limit of small steps and many iterations."""
    return {"dt": 1.0 / 1920.0, "wall": WallSolverCfg(repeats=4)}


def tightest() -> dict[str, Any]:
    """Return the shipped step with the wall solved six times over."""
    return {"wall": WallSolverCfg(repeats=6)}


def push(
    run: Run,
    tube: Tube | None,
    depth: float,
    material: str = "paper",
    rest: float = 0.0,
    wall_model: str = "shell",
    rigid: bool = False,
    refine: int = 0,
    **cfg: Any,
) -> Trace:
    """Push to a depth [m] and wait [s]. The same push is made only once a run; ``tube`` None is the shipped colon.

    With ``refine``, the colon's wall is sampled so much more finely from the smooth surface through its vertices.
    """
    key = ("push", tube, depth, material, rest, wall_model, rigid, refine, str(cfg))
    if key not in run.shared:
        colon: dict[str, Any] = {"material": material, "wall_model": wall_model, "rigid": rigid}
        if refine:
            colon["usd_path"] = str(write_smooth(run.folder, refine, SIGMOID_MOBILE))
        run.shared[key] = _push(run, tube, depth, colon, rest, **cfg)
    return run.shared[key]


def _push(run: Run, tube: Tube | None, depth: float, colon: dict[str, Any], rest: float, **cfg: Any) -> Trace:
    mobile = None
    if tube is None:
        mobile = DEEP_MOBILE if depth >= DEEP else SIGMOID_MOBILE
    sim = build(run, PROXIMAL_CFG, tube, colon={**colon, "mobile_until": mobile}, **cfg)
    steps, trace, scope = round(CONTROL_STEP / sim.physics_dt), Trace(sim), sim.endoscope
    still = torch.zeros(1, device=sim.device)
    scope.set_insertion_command(still + SPEED, still)
    for _ in range(round((depth - scope.rest_insertion) / (SPEED * CONTROL_STEP))):
        sim.step(steps)
        trace.inserted.append(scope.data.inserted_length.item())
        trace.force.append(scope.data.base_force.item())
        trace.tip.append(scope.data.tip_pos_w[0].cpu().numpy().copy())
        trace.moved.append(sim.colon.data.nodal_displacement.max().item())
        trace.volume.append(volume_ratios(sim))
    scope.set_insertion_command(still, still)
    for _ in range(round(rest / CONTROL_STEP)):
        sim.step(steps)
    return trace
