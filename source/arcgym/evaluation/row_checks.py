# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check of the rows of trials: whose they are, and whether their values can be."""

from __future__ import annotations

import math
from collections.abc import Iterator

from arcgym.evaluation.result_folder import TEXTS, Row
from arcgym.evaluation.trials import COLUMNS, Conditions

SHARES = ("s_c", "coverage")
"""Columns from 0 to 1, beside those that end in ``_rate``."""

POSITIVE = ("force", "impulse", "time", "seconds", "strain", "tension", "stretch", "friction", "stiffness", "length")
"""Words in the names of columns that cannot be negative."""

BASIC = ("task", "agent", *COLUMNS, "success", "end", "reward", "seconds")
"""Columns that every row must have."""


def row_problems(rows: list[Row], conditions: Conditions) -> list[str]:
    """Return a line for each row that is no trial of the condition file, or has a value that cannot be."""
    if not rows:
        return ["trials.csv has no row"]
    lacking = [name for name in BASIC if name not in rows[0]]
    if lacking:
        return [f"trials.csv lacks the columns {', '.join(lacking)}"]
    trials = {trial.trial: trial for trial in conditions.trials}
    found, seen = [], set()
    for row in rows:
        label = f"trial {row['trial']} of {row['task']}"
        trial = trials.get(row["trial"])
        if (row["task"], row["trial"]) in seen:
            found.append(f"{label} is there twice")
        seen.add((row["task"], row["trial"]))
        if trial is None or (row["patient"], row["seed"], row["group"]) != (trial.patient, trial.seed, trial.group):
            found.append(f"{label} has another patient, seed or group than the condition file")
        if row["success"] not in (0, 1) or (row["success"] == 1) != (row["end"] == "success"):
            found.append(f"{label} says success {row['success']} and end '{row['end']}'")
        progress = _number(row, "progress", 1.0)
        if not 0.0 <= progress <= 1.0:
            found.append(f"{label} has a progress of {progress}, expected 0 to 1")
        if row["success"] == 1 and progress < _least_progress(row["task"]):
            found.append(f"{label} succeeded with a progress of {progress}")
        found += [f"{label} has {name} = {value}, {why}" for name, value, why in _impossible(row)]
    return found


def _number(row: Row, name: str, otherwise: float) -> float:
    """Return a column of a row; where it is missing or no number, which is told elsewhere, another value."""
    value = row.get(name)
    return value if isinstance(value, int | float) else otherwise


def _least_progress(task: str) -> float:
    """Return the least progress with which a task succeeds.

    The cecum is reached halfway from its valve to its end: at 0.975 of the way in the shortest colon (``ct_2``, 1.19 m)
    and at 0.977 or more in the patients of the split ``test``.
    """
    return 0.97 if "-Cecum-" in task else 0.999


def _impossible(row: Row) -> Iterator[tuple[str, float | str, str]]:
    """Yield the columns of a row whose value cannot be, with why."""
    for name, value in row.items():
        if not isinstance(value, float):
            if isinstance(value, str) and name not in TEXTS:
                yield name, value, "expected a number"
            continue
        if not math.isfinite(value):
            if row["end"] != "non_finite":  # an episode whose state broke may say so
                yield name, value, "expected a finite number"
        elif (name in SHARES or name.endswith("_rate")) and not -1e-6 <= value <= 1.0 + 1e-6:
            yield name, value, "expected 0 to 1"
        elif value < -1e-6 and any(word in name for word in POSITIVE):
            yield name, value, "expected no negative number"
        elif name.startswith("mean_") and value > (most := _number(row, f"max_{name[5:]}", math.inf)) * (1 + 1e-5):
            yield name, value, f"above the largest, {most}"
        elif (
            name.startswith("max_") and value > (peak := _number(row, f"peak_{name[4:]}", math.inf)) * (1 + 1e-5) + 1e-6
        ):
            yield name, value, f"above the peak, {peak}"
