# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushing the shipped colonoscope: through a straight tube, a bend of 100 degrees, and the sigmoid of the colon."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fidelity_checks.models import Tube, build
from fidelity_checks.table import Plot, Row, Run, absolute, check, relative

BEND = Tube(0.40, math.radians(100.0), 0.14, 0.05)
"""Tube with a bend of 100 degrees."""
STRAIGHT = Tube(0.40)
"""Tube without one."""
SPEED = 0.05
"""Speed of the base [m/s]."""
CONTROL_STEP = 0.1
"""Time over which forces are averaged [s]."""
DEPTH = 0.30
"""Inserted length at the end of a push through a tube [m]."""
SIGMOID_DEPTH = 0.36
"""Inserted length at the end of a push into the colon [m]: the tip is in the S of the sigmoid."""
SIGMOID_MOBILE = 0.50
"""Arc length up to which the colon's wall moves in these pushes [m]; the rest would only cost time."""
DEEP, DEEP_MOBILE = 0.55, 0.80
"""The same for a push through the S until the scope, which nobody steers, stands still in its last bend [m]."""
PRESETS = {"stiff": "paper", "soft": "in_situ"}
"""Tissue presets by stiffness."""


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
        """Mean over the second half of the push, when the tip is in the bend or beyond it."""
        return float(np.mean(values[len(values) // 2 :]))


def converged() -> dict[str, Any]:
    """Settings near the limit of small steps and many iterations."""
    from arcgym.sim import WallSolverCfg

    return {"dt": 1.0 / 1920.0, "wall": WallSolverCfg(repeats=4)}


def tightest() -> dict[str, Any]:
    """The shipped step with the wall solved six times over."""
    from arcgym.sim import WallSolverCfg

    return {"wall": WallSolverCfg(repeats=6)}


def push(
    run: Run,
    tube: Tube | None,
    depth: float,
    material: str = "paper",
    rest: float = 0.0,
    wall_model: str = "shell",
    **cfg: Any,
) -> Trace:
    """Push to a depth [m] and wait [s]. The same push is made only once a run; ``tube`` None is the shipped colon."""
    key = ("push", tube, depth, material, rest, wall_model, str(cfg))
    if key not in run.shared:
        run.shared[key] = _push(run, tube, depth, {"material": material, "wall_model": wall_model}, rest, **cfg)
    return run.shared[key]


def _push(run: Run, tube: Tube | None, depth: float, colon: dict[str, Any], rest: float, **cfg: Any) -> Trace:
    import torch

    from arcgym.assets import PROXIMAL_CFG

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


def volume_ratios(sim: Any) -> tuple[float, float]:
    """Smallest and largest volume of a wall element, relative to its rest volume.

    A shell's triangle keeps no record of its thickness; in plane stress it changes by the strain
    E33 = -nu / (1 - nu) (E11 + E22), and the volume by the area's ratio times sqrt(1 + 2 E33).
    """
    from arcgym.anatomy.measures import tet_volumes
    from arcgym.anatomy.shell import ShellMesh

    wall, points = sim.colon.wall, sim.colon.data.nodal_pos_w[0].cpu().numpy().astype(float)
    if isinstance(wall, ShellMesh):
        ratio = shell_volume_ratio(wall.points, points, wall.triangles, sim.colon.elasticity()[1])
    else:
        ratio = tet_volumes(points, wall.tets) / tet_volumes(wall.points.astype(float), wall.tets)
    return float(ratio.min()), float(ratio.max())


def shell_volume_ratio(rest: np.ndarray, now: np.ndarray, triangles: np.ndarray, poissons_ratio: float) -> np.ndarray:
    """Volume of a shell's triangles relative to their rest volume, shape (F,).

    Args:
        rest: Vertices at rest [m], shape (V, 3).
        now: Vertices [m], shape (V, 3).
        triangles: Vertices of each triangle, shape (F, 3).
        poissons_ratio: Poisson's ratio.
    """
    metric = []
    for points in (rest.astype(float), now):
        corners = points[triangles]
        edges = corners[:, 1:] - corners[:, :1]
        metric.append(np.einsum("fai,fbi->fab", edges, edges))
    stretch = np.linalg.solve(metric[0], metric[1])  # similar to F^T F
    trace = 0.5 * (np.trace(stretch, axis1=1, axis2=2) - 2.0)
    thickness = 1.0 - 2.0 * poissons_ratio / (1.0 - poissons_ratio) * trace
    return np.sqrt(np.linalg.det(stretch) * np.maximum(thickness, 0.0))


@check("straight_advance", quick=True)
def straight_advance(run: Run) -> list[Row]:
    """Advance of the tip for a given advance of the base in a straight tube."""
    trace = push(run, STRAIGHT, DEPTH)
    tip = float(trace.tip[-1][2] - trace.tip[0][2])
    base = trace.inserted[-1] - trace.inserted[0]
    advance = 1.0e3 * (np.array(trace.inserted) - trace.inserted[0])
    plot = Plot("straight_advance", "advance of the base [mm]", "advance of the tip [mm]")
    plot.lines.append(("no loss", advance, advance))
    plot.points.append(("shipped settings", advance, [1.0e3 * (p[2] - trace.tip[0][2]) for p in trace.tip]))
    run.plots.append(plot)
    return [relative("straight_advance", tip, base, 0.01, "m")]


@check("volume_stiff", "volume_soft")
def volume(run: Run) -> list[Row]:
    """Volume ratio of the wall's elements while the scope is pushed through the bend."""
    rows, plot = [], Plot("volume", "inserted length [m]", "volume ratio, least and largest")
    for name, material in PRESETS.items():
        trace = push(run, BEND, DEPTH, material, rest=2.0)
        least, largest = np.array(trace.volume).T
        plot.points += [(f"{name}, least", trace.inserted, least), (f"{name}, largest", trace.inserted, largest)]
        ratios = np.array(trace.volume).ravel()
        worst = float(ratios[np.argmax(np.abs(ratios - 1.0))])
        rows.append(absolute(f"volume_{name}", worst, 1.0, 0.05, "", f"{ratios.min():.3f} to {ratios.max():.3f}"))
    plot.lines.append(("incompressible", trace.inserted, np.ones(len(trace.inserted))))
    run.plots.append(plot)
    return rows


@check("bend_force", "bend_tip")
def bend(run: Run) -> list[Row]:
    """Push through a bend of 100 degrees against a converged run."""
    return compare_pushes(run, "bend", BEND, DEPTH)


@check("sigmoid_force", "sigmoid_tip")
def sigmoid(run: Run) -> list[Row]:
    """Push into the S of the shipped colon against a converged run."""
    return compare_pushes(run, "sigmoid", None, SIGMOID_DEPTH)


@check("sigmoid_deep_force", "sigmoid_deep_tip")
def sigmoid_deep(run: Run) -> list[Row]:
    """Push through the S of the shipped colon against a converged run.

    Now and then the tip snaps past a fold a moment earlier or later than in the reference, so that the tips are some
    millimetres apart meanwhile; the row is their mean distance, as the force is a mean.
    """
    force, tip = compare_pushes(run, "sigmoid_deep", None, DEEP)
    mean = float(np.mean(late_distances(run, None, DEEP)))
    return [force, absolute(tip.name, mean, 0.0, tip.bound, "m", f"on average; {1.0e3 * tip.value:.1f} mm at most")]


def late_distances(run: Run, tube: Tube | None, depth: float, rest: float = 0.0) -> np.ndarray:
    """How far the tips of the push and of the converged one are apart in the second half [m]."""
    ours, limit = push(run, tube, depth, rest=rest), push(run, tube, depth, **converged())
    apart = np.linalg.norm(np.array(ours.tip) - np.array(limit.tip), axis=1)
    return apart[len(apart) // 2 :]


def compare_pushes(run: Run, name: str, tube: Tube | None, depth: float) -> list[Row]:
    """Mean force of the second half of the push, and the farthest that the tips are apart in it."""
    rest = 2.0 if tube == BEND else 0.0
    ours, limit = push(run, tube, depth, rest=rest), push(run, tube, depth, **converged())
    late = late_distances(run, tube, depth, rest)
    plot = Plot(f"{name}_force", "inserted length [m]", "push on the base [N]")
    plot.lines.append(("converged", limit.inserted, limit.force))
    plot.points.append(("shipped settings", ours.inserted, ours.force))
    run.plots.append(plot)
    return [
        relative(f"{name}_force", ours.late(ours.force), limit.late(limit.force), 0.10, "N"),
        absolute(
            f"{name}_tip", float(late.max()), 0.0, 0.002, "m", f"largest; {1.0e3 * late.mean():.2f} mm on average"
        ),
    ]


@check("newton_force", "newton_tip")
def plain_newton(run: Run) -> list[Row]:
    """Push through the bend against plain Newton, on the solid wall that it can simulate.

    Newton steps at 1/960 s and needs a scope three times as heavy.
    """
    ours = push(run, BEND, DEPTH, wall_model="solid")
    newton = push(run, BEND, DEPTH, wall_model="solid", solver="newton", dt=1.0 / 960.0, mass_scaling=3.0)
    apart = np.linalg.norm(np.array(ours.tip) - np.array(newton.tip), axis=1)
    plot = Plot("newton_force", "inserted length [m]", "push on the base [N]")
    plot.lines.append(("plain Newton", newton.inserted, newton.force))
    plot.points.append(("shipped solver", ours.inserted, ours.force))
    run.plots.append(plot)
    moved = ours.late(ours.moved) / newton.late(newton.moved) - 1.0
    return [
        relative(
            "newton_force", ours.late(ours.force), newton.late(newton.force), 0.10, "N", f"wall motion {moved:+.1%}"
        ),
        absolute("newton_tip", float(apart.max()), 0.0, 0.002, "m", "largest"),
    ]


@check("wall_motion_stiff", "wall_motion_soft")
def wall_motion(run: Run) -> list[Row]:
    """Largest wall displacement while pushing into the S of the shipped colon, against the tightest inner solve."""
    rows, plot = [], Plot("wall_motion", "inserted length [m]", "largest displacement of the wall [mm]")
    for name, material in PRESETS.items():
        ours = push(run, None, SIGMOID_DEPTH, material)
        tight = push(run, None, SIGMOID_DEPTH, material, **tightest())
        value, reference = ours.late(ours.moved), tight.late(tight.moved)
        rows.append(relative(f"wall_motion_{name}", value, reference, 0.10, "m"))
        plot.lines.append((f"{name}, solved six times", tight.inserted, [1.0e3 * m for m in tight.moved]))
        plot.points.append((f"{name}, shipped settings", ours.inserted, [1.0e3 * m for m in ours.moved]))
    run.plots.append(plot)
    return rows
