# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What agents reach that learn nothing, a row a task and agent in one small file. Loads neither torch nor Warp.

Result folders come and go; this file stays, and each of its rows says by what commit and on which machine it was made.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.evaluation.results import Result, best
from arcgym.evaluation.statistics import Interval
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.summary import summarize
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP
from arcgym.utils.errors import UsageError
from arcgym.utils.untrained import UNTRAINED

AGENTS = UNTRAINED
"""Baselines, in the order of the rows."""

FIGURES = {
    "success": ("success [%]", 0),
    "progress": ("progress", 2),
    "seconds": ("time [s]", 1),
    "p95_tip_force": ("p95 tip force [N]", 2),
    "p95_shaft_force": ("p95 shaft force [N]", 2),
    "looping_ratio": ("looping ratio", 2),
    "path_efficiency": ("path efficiency", 2),
    "coverage": ("coverage", 2),
}
"""Heading and digits of the figures, where trials have them."""

BOUNDS = ("", "_low", "_high")
"""Ends of the columns of an estimate and of its bounds."""

ABOUT = ("suite", "conditions", "task", "agent", "trials", "commit", "machine", "physics_hz", "stuck_after_s")
"""Columns before those of the figures."""

DIGITS = 4
"""Significant digits in the file; a table shows three."""


@dataclass(frozen=True)
class Baseline:
    """Figures of one agent in one task of a suite."""

    suite: str
    """Name of the suite."""
    conditions: str
    """Its condition file, or an earlier one of other patients in part."""
    task: str
    """Registered name, with ``:variant`` behind it or without."""
    agent: str
    """One of :data:`AGENTS`."""
    trials: int
    """Number of trials: all of the suite's, or each n-th one."""
    commit: str
    """Commit of the code that ran them."""
    machine: str
    """Processor and accelerator."""
    physics_hz: float
    """Physics steps a second."""
    stuck_after_s: float | None
    """Time without progress after which an episode was stuck [s]; None where none ends so."""
    figures: dict[str, Interval]
    """Estimates with their bounds, by name in :data:`FIGURES`."""

    @property
    def key(self) -> tuple[str, str, str]:
        """Suite, task and agent: there is one row of each."""
        return self.suite, self.task, self.agent

    @property
    def is_current(self) -> bool:
        """Whether trials, physics steps and patience are those that suite and task have now."""
        of_now = self.is_of_present_steps and self.is_of_present_patience
        return self.conditions == read_suites()[self.suite].conditions and of_now

    @property
    def is_of_present_steps(self) -> bool:
        """Whether the task has as many physics steps a second now."""
        return self.physics_hz == PHYSICS_STEP.registered(self.task)

    @property
    def is_of_present_patience(self) -> bool:
        """Whether an episode of the task is stuck after that time now."""
        return self.stuck_after_s == PATIENCE.registered(self.task)


def baselines_of(results: Iterable[Result]) -> list[Baseline]:
    """Return the baselines in results, of each suite, task and agent the one with the most trials."""
    groups: dict[tuple[str, str, str], list[Result]] = {}
    for one in results:
        if one.method in AGENTS:
            groups.setdefault((one.suite, one.task, one.method), []).append(one)
    return [_baseline(chosen) for own in groups.values() if (chosen := best(own))]


def updated(known: Sequence[Baseline], new: Sequence[Baseline]) -> list[Baseline]:
    """Return the known rows with new ones in their places, in the order of suites, tasks and agents.

    A new row takes a place if it has at least as many trials and every figure of the one before: fewer trials, or a
    small copy of a folder without some columns, replace nothing. Trials of the suite's present condition file and
    of the task's present physics steps take the place of earlier ones, and earlier ones none of theirs.
    """
    rows = {one.key: one for one in known}
    for one in new:
        old = rows.get(one.key)
        if old is None or _is_better(one, old):
            rows[one.key] = one
    suites = list(read_suites())
    return sorted(rows.values(), key=lambda one: (suites.index(one.suite), one.task, AGENTS.index(one.agent)))


def _is_better(new: Baseline, old: Baseline) -> bool:
    if new.is_current != old.is_current:
        return new.is_current
    return new.trials >= old.trials and set(old.figures) <= set(new.figures)


def read_baselines(path: Path) -> list[Baseline]:
    """Return the rows of a file; none if there is no file.

    Raises:
        UsageError: A row names a suite or an agent that there is not.
    """
    if not path.is_file():
        return []
    with path.open(newline="") as file:
        baselines = [_read(row) for row in csv.DictReader(file)]
    for one in baselines:
        if one.suite not in read_suites() or one.agent not in AGENTS:
            raise UsageError(f"{path} has {one.agent} in '{one.suite}'; expected {', '.join(AGENTS)} in a suite.")
    return baselines


def write_baselines(path: Path, baselines: Sequence[Baseline]) -> None:
    """Write rows into a file."""
    out = io.StringIO()
    columns = [*ABOUT, *(name + bound for name in FIGURES for bound in BOUNDS)]
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(_cells(one) for one in baselines)
    path.write_text(out.getvalue())


def _baseline(result: Result) -> Baseline:
    (summary,) = summarize(result.rows).values()
    figures = {name: summary[name] for name in FIGURES if name in summary}
    about = (
        result.suite,
        result.conditions,
        result.task,
        result.method,
        summary["trials"],
        result.commit,
        result.run["machine"],
        result.steps,
        result.patience,
    )
    return Baseline(*about, figures)


def _cells(one: Baseline) -> dict[str, Any]:
    cells: dict[str, Any] = {name: getattr(one, name) for name in ABOUT}
    for entry in (PHYSICS_STEP.entry, PATIENCE.entry):
        cells[entry] = "" if cells[entry] is None else f"{cells[entry]:g}"
    for name, interval in one.figures.items():
        values = zip(BOUNDS, (interval.value, interval.low, interval.high), strict=True)
        cells |= {name + bound: f"{value:.{DIGITS}g}" for bound, value in values}
    return cells


def _read(row: dict[str, str]) -> Baseline:
    figures = {
        name: Interval(*(float(row[name + bound]) for bound in BOUNDS)) for name in FIGURES if row.get(name, "") != ""
    }
    about: dict[str, Any] = {name: row.get(name) for name in ABOUT}
    about["trials"] = int(row["trials"])
    for setting in (PHYSICS_STEP, PATIENCE):
        said = {row["task"]: float(row[setting.entry])} if row.get(setting.entry) else {}
        about[setting.entry] = setting.in_run({setting.entry: said}, row["task"])
    return Baseline(**about, figures=figures)
