# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a policy stands: a table of the robustness variants, a line a kind, a column a strength. Loads no torch."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from arcgym.evaluation.statistics import paired_difference, training_runs, wilson
from arcgym.evaluation.suites import split_task

STRENGTHS = ("1", "2", "3")
UNSPOILED = "none"
"""Variant that the others are compared with."""


def strengths_table(rows: Sequence[dict[str, Any]]) -> str:
    """Return success [%] and change of the mean progress by kind and strength, in Markdown; empty without variants.

    Changes are mean differences to the same trials of the variant ``none``, with 95 % bootstrap intervals.

    Args:
        rows: Rows of trials; those of tasks such as ``ARC-LeftColon-Magnetic:blur_2`` are shown.
    """
    cells: dict[tuple[str, str], dict[tuple[str, str], list[dict[str, Any]]]] = {}
    for row in rows:
        task, variant = split_task(row["task"])
        match = re.fullmatch(r"([a-z]+)_([123])", variant or "")
        if match or variant == UNSPOILED:
            place = (match[1], match[2]) if match else (UNSPOILED, "")
            cells.setdefault((task, str(row["agent"])), {}).setdefault(place, []).append(row)
    return "\n".join(_table(task, agent, of) for (task, agent), of in cells.items() if set(of) - {(UNSPOILED, "")})


def _table(task: str, agent: str, of: dict[tuple[str, str], list[dict[str, Any]]]) -> str:
    plain = {row["trial"]: row for row in of.get((UNSPOILED, ""), [])}
    head = [
        f"**`{task}`, {agent}.** Success [%] in {len(plain)} trials as they are: {_success(list(plain.values()))}.",
        "",
    ]
    columns = [f"success [%], {s}" for s in STRENGTHS] + [f"progress, {s} less none" for s in STRENGTHS]
    head += [f"| kind | {' | '.join(columns)} |", f"|{'---|' * (len(columns) + 1)}"]
    lines = []
    for kind in dict.fromkeys(kind for kind, _ in of if kind != UNSPOILED):
        found = [of.get((kind, strength), []) for strength in STRENGTHS]
        cells = [*map(_success, found), *(_change(rows, plain) for rows in found)]
        lines.append(f"| {kind} | {' | '.join(cells)} |")
    return "\n".join([*head, *lines]) + "\n"


def _success(rows: Sequence[dict[str, Any]]) -> str:
    if not rows:
        return "no trial"
    of = wilson(sum(row["success"] for row in rows), len(rows))
    return f"{100 * of.value:.0f} ({100 * of.low:.0f}–{100 * of.high:.0f})"


def _change(rows: Sequence[dict[str, Any]], plain: dict[int, dict[str, Any]]) -> str:
    both = [row for row in rows if row["trial"] in plain]
    if not both:
        return ""
    first = np.array([plain[row["trial"]]["progress"] for row in both], float)
    second = np.array([row["progress"] for row in both], float)
    of = paired_difference(first, second, training_runs(both))
    return f"{of.value:+.2f} ({of.low:+.2f} to {of.high:+.2f})"
