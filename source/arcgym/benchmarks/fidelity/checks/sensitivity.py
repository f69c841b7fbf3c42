# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the forces of a scripted insertion depend on settings that are of the numerics alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from arcgym.benchmarks.fidelity.insertions import (
    FAR,
    METRICS,
    SCENES,
    SETTINGS,
    insert_all,
    mean_figures,
)
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run

TIMES = ("time_above_5N",)
"""Figures that have a row of their own: what a force near the limit does to a time above it is not what it does to
forces."""
FORCES = tuple(name for name in METRICS if name not in TIMES)
"""The other figures."""
LEAST_SHARE = 0.1
"""Share of an insertion above 5 N from which that time is judged: of a shorter one, chance decides."""
LEAST = {"time_above_5N": 1.0}
"""Figures smaller than this are compared as if they were as large: times of a few samples [s]."""
LEAST_FORCE = 0.1
"""The same for forces [N]."""


def sensitivity(run: Run, setting: str) -> list[Row]:
    """Change one setting in all insertions; the rows are the largest change of any force, and of the time above 5 N."""
    found = insert_all(run, [*SCENES, *(replace(case, setting=setting) for case in SCENES)])
    scenes = [case.scene for case in SCENES]
    old, new = (dict(zip(scenes, part, strict=True)) for part in (found[: len(scenes)], found[len(scenes) :]))
    before, after = ({scene: mean_figures(figures[scene]) for scene in scenes} for figures in (old, new))
    compared = {scene: [*METRICS, *(FAR + name for name in METRICS if FAR + name in before[scene])] for scene in scenes}
    table = {scene: {name: change(before[scene], after[scene], name) for name in compared[scene]} for scene in scenes}
    errors = {s: {name: standard_error(old[s], new[s], name) for name in compared[s]} for s in scenes}
    keep(run, setting, table, before)
    run.tables.setdefault("sensitivity_standard_error", {})[setting] = errors
    rows = []
    for row, names in ((f"sensitivity_{setting}", FORCES), (f"sensitivity_{setting}_time", TIMES)):
        judged = [scene for scene in scenes if names is FORCES or is_timed(before[scene])]
        worst = {scene: max((abs(table[scene][at]), at) for at in names)[1] for scene in judged}
        scene, name = max(worst.items(), key=lambda at: abs(table[at[0]][at[1]]))
        largest = "; ".join(
            f"{scene}: {table[scene][at]:+.0%} ± {errors[scene][at]:.0%}" for scene, at in worst.items()
        )
        note = f"{SETTINGS[setting]}: {name} of {scene}; largest change, ± standard error, of {largest}"
        unit = "s" if name in TIMES else "N"
        rows.append(Row(row, after[scene][name], before[scene][name], table[scene][name], 0.1, unit, note))
    return rows


def is_timed(figures: dict[str, float]) -> bool:
    """Return whether the shipped settings have enough time above 5 N for a change of it to mean something."""
    return figures["time_above_5N"] >= LEAST_SHARE * figures["time"]


def change(old: dict[str, float], new: dict[str, float], name: str) -> float:
    """Return the relative change of a figure."""
    return (new[name] - old[name]) / scale(old, name)


def scale(old: dict[str, float], name: str) -> float:
    """Return what a figure's change is divided by: the figure before, but no less than is worth comparing [N or s]."""
    return max(old[name], LEAST.get(name.removeprefix(FAR), LEAST_FORCE))


def standard_error(old: list[dict[str, float]], new: list[dict[str, float]], name: str) -> float:
    """Return the standard error of a figure's relative change, from pairs of insertions at the same speed."""
    by = [b[name] - a[name] for a, b in zip(old, new, strict=True)]
    return float(np.std(by, ddof=1) / np.sqrt(len(by))) / scale(mean_figures(old), name)


def keep(run: Run, setting: str, table: dict[str, dict[str, float]], shipped: dict[str, dict[str, float]]) -> None:
    """Add the changes to the run's table of sensitivities, and to its picture."""
    known = run.tables.setdefault("sensitivity", {"shipped": shipped})
    known[setting] = table
    plot = next((plot for plot in run.plots if plot.name == "sensitivity"), None)
    if plot is None:
        plot = Plot("sensitivity", "setting: " + ", ".join(SETTINGS), "change [%]")
        run.plots.append(plot)
        plot.bands.append(("bound", [0.0, len(SETTINGS) - 1.0], [-10.0, -10.0], [10.0, 10.0]))
    done = [name for name in SETTINGS if name in known]
    places = [list(SETTINGS).index(name) for name in done]
    plot.points = [
        (scene, places, [100.0 * max((known[name][scene][at] for at in METRICS), key=abs) for name in done])
        for scene in table
    ]
