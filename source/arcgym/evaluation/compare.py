# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two agents on the same trials."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from arcgym.evaluation.agent_fields import is_agents
from arcgym.evaluation.result_folder import read_run, read_trial_rows
from arcgym.evaluation.statistics import Interval, paired_difference, training_runs
from arcgym.evaluation.summary import KEY_METRICS
from arcgym.evaluation.task_settings import SETTINGS
from arcgym.utils.errors import UsageError

SAME = ("suite", "conditions_sha256")
"""Entries of the runs that must agree."""


def compare(first: Path, second: Path) -> dict[str, dict[str, Interval]]:
    """Return the mean difference, second minus first, of success and the key metrics of each task both have run.

    Args:
        first: Result folder of one agent.
        second: Result folder of the other.

    Raises:
        UsageError: The folders are of other trials, or have none in common.
    """
    runs = [read_run(path) for path in (first, second)]
    for name in SAME:
        if runs[0].get(name) != runs[1].get(name):
            raise UsageError(
                f"{first} and {second} cannot be compared: {name} is {runs[0].get(name)!r} and {runs[1].get(name)!r}."
            )
    rows = [{(row["task"], row["trial"]): row for row in read_trial_rows(path)} for path in (first, second)]
    common = [key for key in rows[0] if key in rows[1]]
    if not common:
        raise UsageError(f"{first} and {second} have no trial in common.")
    by_task = {task: [key for key in common if key[0] == task] for task in sorted({task for task, _ in common})}
    return {task: _differences(*([by_key[key] for key in keys] for by_key in rows)) for task, keys in by_task.items()}


def notes(first: Path, second: Path) -> list[str]:
    """Return a line for all in which two folders differ beside their agents: differences may be of that, too.

    These are versions (other code may draw and move otherwise), the machine, overrides, settings of a task, and the
    trials that only one of them has.
    """
    runs = [read_run(path) for path in (first, second)]
    settings = [
        {**run.get("versions", {}), "machine": run.get("machine"), "overrides": run.get("overrides"), **_settings(run)}
        for run in runs
    ]
    names = [name for name in {**settings[0], **settings[1]} if settings[0].get(name) != settings[1].get(name)]
    lines = [
        f"note: {name} is {settings[0].get(name)} in {first} and {settings[1].get(name)} in {second}" for name in names
    ]
    keys = [{(row["task"], row["trial"]) for row in read_trial_rows(path)} for path in (first, second)]
    if keys[0] != keys[1]:
        common = len(keys[0] & keys[1])
        lines.append(f"note: {common} trials are of both, of {len(keys[0])} in {first} and {len(keys[1])} in {second}")
    return lines


def _settings(run: dict[str, Any]) -> dict[str, Any]:
    """Return physics step, scope and patience, and all settings that are not as registered and not the agent's."""
    tasks = run.get("changes", {})
    recorded = {
        f"{task} {setting.name}": setting.as_text(setting.in_run(run, task)) for setting in SETTINGS for task in tasks
    }
    others = {
        f"{task} {path}": used
        for task, changes in tasks.items()
        for path, (_, used) in changes.items()
        if not is_agents(path, used)
    }
    return recorded | others


def to_markdown(differences: dict[str, dict[str, Interval]]) -> str:
    """Return the differences as a table: mean and 95 % interval."""
    names = list(next(iter(differences.values())))
    lines = ["| task | " + " | ".join(names) + " |", "|---|" + "---|" * len(names)]
    for task, intervals in differences.items():
        cells = [
            f"{intervals[name].value:+.3g} ({intervals[name].low:+.3g} to {intervals[name].high:+.3g})"
            for name in names
        ]
        lines.append(f"| `{task}` | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _differences(first: list[dict[str, Any]], second: list[dict[str, Any]]) -> dict[str, Interval]:
    runs = training_runs(first) * len(second) + training_runs(second)
    names = [name for name in ("success", *KEY_METRICS) if name in first[0] and name in second[0]]
    return {
        name: paired_difference(
            np.array([row[name] for row in first], float), np.array([row[name] for row in second], float), runs
        )
        for name in names
    }
