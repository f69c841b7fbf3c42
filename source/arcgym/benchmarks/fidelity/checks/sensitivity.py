# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the forces of a scripted insertion depend on settings that are of the numerics alone."""

from __future__ import annotations

import itertools

from arcgym.benchmarks.fidelity.insertions import METRICS, SETTINGS, SPECS, Insertion, insert_all
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run

TIMES = ("time_above_5N",)
"""Figures that have a row of their own: what a force near the limit does to a time above it is not what it does to
forces."""
FORCES = tuple(name for name in METRICS if name not in TIMES)
"""The other figures."""
MATERIALS = ("paper", "in_situ")
"""Tissue presets."""
LEAST = {"time_above_5N": 1.0}
"""Figures smaller than this are compared as if they were as large: times of a few samples [s]."""
LEAST_FORCE = 0.1
"""The same for forces [N]."""


def sensitivity(run: Run, setting: str) -> list[Row]:
    """Change one setting in all insertions; the rows are the largest change of any force, and of the time above 5 N."""
    cases = [Insertion(robot, material) for robot in SPECS for material in MATERIALS]
    changed = [Insertion(case.robot, case.material, setting) for case in cases]
    figures = insert_all(run, cases + changed)
    scenes = [f"{case.robot}, {case.material}" for case in cases]
    before, after = (dict(zip(scenes, part, strict=True)) for part in (figures[: len(cases)], figures[len(cases) :]))
    table = {scene: {name: change(before[scene], after[scene], name) for name in METRICS} for scene in scenes}
    keep(run, setting, table, before)
    rows = []
    for row, names in ((f"sensitivity_{setting}", FORCES), (f"sensitivity_{setting}_time", TIMES)):
        scene, name = max(itertools.product(scenes, names), key=lambda at: abs(table[at[0]][at[1]]))
        largest = "; ".join(f"{of}: {max(abs(table[of][name]) for name in names):.0%}" for of in scenes)
        note = f"{SETTINGS[setting]}: {name} of {scene}; largest change of {largest}"
        unit = "s" if name in TIMES else "N"
        rows.append(Row(row, after[scene][name], before[scene][name], table[scene][name], 0.1, unit, note))
    return rows


def change(old: dict[str, float], new: dict[str, float], name: str) -> float:
    """Return the relative change of a figure."""
    return (new[name] - old[name]) / max(old[name], LEAST.get(name, LEAST_FORCE))


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
        (scene, places, [100.0 * max(known[name][scene].values(), key=abs) for name in done]) for scene in table
    ]
