# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of an evaluation over its trials."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arcgym.evaluation.statistics import Interval, bootstrap, training_runs, wilson
from arcgym.evaluation.strengths import strengths_tables
from arcgym.utils.errors import UsageError

KEY_METRICS = (
    "progress",
    "seconds",
    "s_c",
    "centered_rate",
    "visible_rate",
    "p95_tip_force",
    "p95_shaft_force",
    "shaft_time_above_unsafe",
    "max_base_force",
    "looping_ratio",
    "path_efficiency",
    "coverage",
    "polyps_seen",
)
"""Columns of the summary, if the rows have them: interquartile means over all trials."""

Summary = dict[str, Any]
"""Figures of one task: ``trials``, ``success`` and the key metrics as intervals."""


def summarize(rows: Sequence[dict[str, Any]]) -> dict[str, Summary]:
    """Return the figures of each task.

    Args:
        rows: Rows of trials.

    Raises:
        UsageError: There is no row: nothing was evaluated.
    """
    if not rows:
        raise UsageError("No trial was finished, so there is nothing to report: see the log of the run.")
    tasks = sorted({row["task"] for row in rows})
    return {task: _summary([row for row in rows if row["task"] == task]) for task in tasks}


def report(rows: Sequence[dict[str, Any]]) -> str:
    """Return the figures of each task, and below them what robustness variants change, in Markdown.

    Raises:
        UsageError: There is no row.
    """
    return "\n".join([to_markdown(summarize(rows)), *(table.to_markdown() for table in strengths_tables(rows))])


def to_markdown(summaries: dict[str, Summary]) -> str:
    """Return the figures as a table: value and 95 % interval."""
    names = [name for name in KEY_METRICS if any(name in summary for summary in summaries.values())]
    lines = [
        "| task | trials | success [%] | " + " | ".join(names) + " |",
        "|---|---|---|" + "---|" * len(names),
    ]
    for task, summary in summaries.items():
        success = _text(summary["success"], 100.0, 0)
        cells = [_text(summary[name]) if name in summary else "" for name in names]
        lines.append(f"| `{task}` | {summary['trials']} | {success} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _summary(rows: list[dict[str, Any]]) -> Summary:
    runs = training_runs(rows)
    out: Summary = {"trials": len(rows), "success": wilson(sum(row["success"] for row in rows), len(rows))}
    for name in KEY_METRICS:
        if name in rows[0]:
            out[name] = bootstrap(np.array([row[name] for row in rows], float), runs)
    return out


def _text(interval: Interval, factor: float = 1.0, digits: int = 2) -> str:
    value, low, high = (f"{factor * number:.{digits}f}" for number in (interval.value, interval.low, interval.high))
    return f"{value} ({low}–{high})"
