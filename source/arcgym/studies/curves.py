# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Curves of a cell over transitions and wall time, from the logs of its runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from arcgym.rl.first_episodes import read_rows, write_rows
from arcgym.studies.cell import Cell

CURVES_FILE = "curves.csv"
"""A row an iteration of the cell."""

COLUMNS = {
    "transitions": "Perf/transitions",
    "seconds": "Perf/seconds",
    "reward": "Train/mean_reward",
    "episode_length": "Train/mean_episode_length",
    "success": "Episode_Metrics/success",
    "progress": "Episode_Metrics/progress",
    "tip_time_above_unsafe": "Episode_Metrics/tip_time_above_unsafe",
    "collection_time": "Perf/collection_time",
    "learning_time": "Perf/learning_time",
}
"""Name of each column and its tag in the log. Beside them are ``cost_<name>`` and ``multiplier_<name>``."""

PREFIXES = {"Episode_Cost/": "cost_", "Loss/multiplier": "multiplier"}
"""Beginnings of tags that become columns of their own."""


def make_curves(cell: Cell) -> list[dict[str, Any]]:
    """Read the logs of a cell's runs, write ``curves.csv`` to its folder, and return its rows.

    Iterations that a killed run made after its last checkpoint are left out: the resumed run made them again.
    """
    rows: dict[int, dict[str, Any]] = {}
    for run in cell.runs:
        part = read_log(run)
        if part:
            rows = {iteration: row for iteration, row in rows.items() if iteration < min(part)} | part
    table = [{"iteration": iteration, **row} for iteration, row in sorted(rows.items())]
    names = list(dict.fromkeys(name for row in table for name in row))
    table = [{name: row.get(name, "") for name in names} for row in table]
    write_rows(cell.folder / CURVES_FILE, table)
    return table


def read_curves(cell: Cell) -> list[dict[str, Any]]:
    """Return the rows of a cell's ``curves.csv``; none before it is written. What an iteration lacks is an empty text.

    What :data:`COLUMNS` calls success is the mean over the episodes that ended in an iteration, with the noise that the
    policy explores with: short episodes count more often.
    """
    path = cell.folder / CURVES_FILE
    return read_rows(path) if path.is_file() else []


def read_log(run: Path) -> dict[int, dict[str, Any]]:
    """Return the columns of each iteration in a run's TensorBoard log."""
    from tensorboard.backend.event_processing.event_accumulator import SCALARS, EventAccumulator

    log = EventAccumulator(str(run), size_guidance={SCALARS: 0})
    log.Reload()
    tags = {tag: name for name, tag in COLUMNS.items()}
    for tag in log.Tags()[SCALARS]:
        for prefix, name in PREFIXES.items():
            if tag.startswith(prefix):
                tags[tag] = name + tag.removeprefix(prefix)
    rows: dict[int, dict[str, Any]] = {}
    for tag, name in tags.items():
        for event in log.Scalars(tag) if tag in log.Tags()[SCALARS] else []:
            rows.setdefault(event.step, {})[name] = round(event.value, 6)
    return rows
