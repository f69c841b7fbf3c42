# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the forces of a scripted insertion depend on settings that are of the numerics alone."""

from __future__ import annotations

from arcgym.benchmarks.fidelity.insertions import METRICS, SETTINGS, SPECS, Insertion, insert_all
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run

MATERIALS = ("paper", "in_situ")
"""Tissue presets."""
LEAST = {"time_above_5N": 1.0}
"""Figures smaller than this are compared as if they were as large: times of a few samples [s]."""
LEAST_FORCE = 0.1
"""The same for forces [N]."""


def sensitivity(run: Run, setting: str) -> list[Row]:
    """Change one setting in four insertions; the row is the largest change of any figure."""
    cases = [Insertion(robot, material) for robot in SPECS for material in MATERIALS]
    changed = [Insertion(case.robot, case.material, setting) for case in cases]
    figures = insert_all(run, cases + changed)
    before, after = figures[: len(cases)], figures[len(cases) :]
    table = {
        f"{case.robot}, {case.material}": {name: change(old, new, name) for name in METRICS}
        for case, old, new in zip(cases, before, after, strict=True)
    }
    keep(run, setting, table, {f"{case.robot}, {case.material}": old for case, old in zip(cases, before, strict=True)})
    scene, name = max(((scene, name) for scene in table for name in METRICS), key=lambda at: abs(table[at[0]][at[1]]))
    worst = list(table).index(scene)
    unit = "s" if name.startswith("time") else "N"
    per_scene = "; ".join(f"{k}: {max(map(abs, v.values())):.0%}" for k, v in table.items())
    note = f"{SETTINGS[setting]}: {name} of {scene}; largest change of {per_scene}"
    return [Row(f"sensitivity_{setting}", after[worst][name], before[worst][name], table[scene][name], 0.1, unit, note)]


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
