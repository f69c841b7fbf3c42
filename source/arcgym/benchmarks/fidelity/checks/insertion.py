# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pushing the shipped colonoscope: through a straight tube, a bend of 100 degrees, and the sigmoid of the colon."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.benchmarks.fidelity.pushes import (
    BEND,
    DEEP,
    DEPTH,
    SIGMOID_DEPTH,
    STRAIGHT,
    converged,
    push,
    tightest,
)
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute, relative
from arcgym.benchmarks.fidelity.tubes import Tube
from arcgym.sim import ContactCfg

PRESETS = {"stiff": "paper", "soft": "in_situ"}
"""Tissue presets by stiffness."""


def straight_advance(run: Run) -> list[Row]:
    """Measure the advance of the tip for a given advance of the base in a straight tube."""
    trace = push(run, STRAIGHT, DEPTH)
    tip = float(trace.tip[-1][2] - trace.tip[0][2])
    base = trace.inserted[-1] - trace.inserted[0]
    advance = 1.0e3 * (np.array(trace.inserted) - trace.inserted[0])
    plot = Plot("straight_advance", "advance of the base [mm]", "advance of the tip [mm]")
    plot.lines.append(("no loss", advance, advance))
    plot.points.append(("shipped settings", advance, [1.0e3 * (p[2] - trace.tip[0][2]) for p in trace.tip]))
    run.plots.append(plot)
    return [relative("straight_advance", tip, base, 0.01, "m")]


def volume(run: Run) -> list[Row]:
    """Measure the volume ratio of the wall's elements while the scope is pushed through the bend."""
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


def bend(run: Run) -> list[Row]:
    """Push through a bend of 100 degrees against a converged run."""
    return compare_pushes(run, "bend", BEND, DEPTH)


def sigmoid(run: Run) -> list[Row]:
    """Push into the S of the shipped colon against a converged run."""
    return compare_pushes(run, "sigmoid", None, SIGMOID_DEPTH)


def sigmoid_deep(run: Run, name: str = "sigmoid_deep", step_damping: float | None = None) -> list[Row]:
    """Push through the S of the shipped colon against a converged run.

    Now and then the tip snaps past a fold a moment earlier or later than in the reference, so that the tips are some
    millimeters apart meanwhile; the row is their mean distance, as the force is a mean.

    Args:
        run: Device and folder.
        name: Begin of the rows' names.
        step_damping: ``ContactCfg.step_damping`` of both runs; the default if None.
    """
    changes: dict[str, Any] = {} if step_damping is None else {"contact": ContactCfg(step_damping=step_damping)}
    force, tip = compare_pushes(run, name, None, DEEP, **changes)
    mean = float(np.mean(late_distances(run, None, DEEP, **changes)))
    return [force, absolute(tip.name, mean, 0.0, tip.bound, "m", f"on average; {1.0e3 * tip.value:.1f} mm at most")]


def late_distances(run: Run, tube: Tube | None, depth: float, rest: float = 0.0, **changes: Any) -> np.ndarray:
    """Return how far the tips of the push and of the converged one are apart in the second half [m]."""
    ours, limit = push(run, tube, depth, rest=rest, **changes), push(run, tube, depth, **converged(), **changes)
    apart = np.linalg.norm(np.array(ours.tip) - np.array(limit.tip), axis=1)
    return apart[len(apart) // 2 :]


def compare_pushes(run: Run, name: str, tube: Tube | None, depth: float, **changes: Any) -> list[Row]:
    """Compare the mean force of the second half, and the largest distance of the tips in it.

    ``changes`` of ``SimulationCfg`` are those of both runs.
    """
    rest = 2.0 if tube == BEND else 0.0
    ours, limit = push(run, tube, depth, rest=rest, **changes), push(run, tube, depth, **converged(), **changes)
    late = late_distances(run, tube, depth, rest, **changes)
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


def plain_newton(run: Run) -> list[Row]:
    """Push through the bend against plain Newton, on the solid wall that it can simulate.

    Newton steps at 1/960 s, in as many substeps as ours, and needs a scope three times as heavy.
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


def wall_motion(run: Run) -> list[Row]:
    """Measure the largest wall displacement while pushing into the sigmoid's S, against the tightest inner solve."""
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
