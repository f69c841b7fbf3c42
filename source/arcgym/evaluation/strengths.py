# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a policy stands: a table of the robustness variants, a line a kind, a column a strength. Loads no torch."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.evaluation.statistics import paired_difference, training_runs, wilson
from arcgym.evaluation.suites import read_suites, split_task

STRENGTHS = ("1", "2", "3")
"""Ends of the names of robustness variants, from weak to strong."""
UNSPOILED = "none"
"""Variant that the others are compared with."""
Cells = dict[tuple[str, str], list[dict[str, Any]]]
"""Rows of trials by kind and strength."""


@dataclass(frozen=True)
class StrengthsTable:
    """Success and change of the mean progress of one agent in one task, by kind and strength."""

    title: str
    """Task and agent, a checkpoint by its last two names, and the success without trouble."""

    head: list[str]
    """Headings of the columns."""

    lines: list[list[str]]
    """A line a kind."""

    def to_markdown(self) -> str:
        """Return the table with its title above it."""
        rows = [self.head, ["---"] * len(self.head), *self.lines]
        return f"**{self.title}**\n\n" + "".join(f"| {' | '.join(row)} |\n" for row in rows)


def strengths_tables(rows: Sequence[dict[str, Any]]) -> list[StrengthsTable]:
    """Return success [%] and change of the mean progress by kind and strength, a table a task and agent.

    Changes are mean differences to the same trials of the variant ``none``, with 95 % bootstrap intervals.

    Args:
        rows: Rows of trials; those of tasks such as ``ARC-LeftColon-Magnetic:blur_2`` are shown.
    """
    cells: dict[tuple[str, str], Cells] = {}
    for row in rows:
        task, variant = split_task(row["task"])
        match = re.fullmatch(r"([a-z]+)_([123])", variant or "")
        if match or variant == UNSPOILED:
            place = (match[1], match[2]) if match else (UNSPOILED, "")
            cells.setdefault((task, str(row["agent"])), {}).setdefault(place, []).append(row)
    return [_table(task, agent, own) for (task, agent), own in cells.items() if set(own) - {(UNSPOILED, "")}]


def _table(task: str, agent: str, cells: Cells) -> StrengthsTable:
    plain = {row["trial"]: row for row in cells.get((UNSPOILED, ""), [])}
    who = "/".join(Path(agent).parts[-2:])
    title = f"{task}, {who}: success {_success(list(plain.values()))} % in {len(plain)} trials without trouble"
    columns = [f"success [%], {s}" for s in STRENGTHS] + [f"progress, {s} less none" for s in STRENGTHS]
    lines = []
    for kind in _ordered({kind for kind, _ in cells} - {UNSPOILED}):
        found = [cells.get((kind, strength), []) for strength in STRENGTHS]
        lines.append([kind, *map(_success, found), *(_change(some, plain) for some in found)])
    return StrengthsTable(title, ["kind", *columns], lines)


def _ordered(kinds: set[str]) -> list[str]:
    """Return kinds in the order of the suite, whatever the order in which parts were merged."""
    order = [variant.rpartition("_")[0] for variant in read_suites()["robustness"].variants]
    return sorted(kinds, key=lambda kind: (order.index(kind) if kind in order else len(order), kind))


def _success(rows: Sequence[dict[str, Any]]) -> str:
    if not rows:
        return "no trial"
    rate = wilson(sum(row["success"] for row in rows), len(rows))
    return f"{100 * rate.value:.0f} ({100 * rate.low:.0f}–{100 * rate.high:.0f})"


def _change(rows: Sequence[dict[str, Any]], plain: dict[int, dict[str, Any]]) -> str:
    both = [row for row in rows if row["trial"] in plain]
    if not both:
        return ""
    first = np.array([plain[row["trial"]]["progress"] for row in both], float)
    second = np.array([row["progress"] for row in both], float)
    change = paired_difference(first, second, training_runs(both))
    return f"{change.value:+.2f} ({change.low:+.2f} to {change.high:+.2f})"
