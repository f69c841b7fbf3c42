# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The table of how far experts get."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.segments import SEGMENTS

COLUMNS = ("robot", "tissue", "segment", "entered", "time [s]", "tip [N]", "50 mm of scope [N]", "drive [N]")
"""Headings; forces are the largest on the way so far."""


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a file of JSON lines; a line that was cut off is left out."""
    rows = []
    for line in path.read_text().splitlines() if path.is_file() else ():
        try:
            rows.append(json.loads(line))
        except ValueError:
            continue
    return rows


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Return how many patients each robot gets how far in, in Markdown; figures are median (95th percentile)."""
    lines = [" | ".join(("", *COLUMNS, "")).strip(), "|---" * len(COLUMNS) + "|"]
    for robot, tissue in dict.fromkeys((robot_of(row), row["tissue"]) for row in rows):
        own = [row for row in rows if (robot_of(row), row["tissue"]) == (robot, tissue)]
        for segment in SEGMENTS[1:]:
            cells = (robot, tissue, segment, *_of_segment(own, segment))
            lines.append(" | ".join(("", *cells, "")).strip())
    return "\n".join(lines)


def robot_of(row: dict[str, Any]) -> str:
    """Return the robot of a row, with its length [m] where that is not the shipped one."""
    length = row.get("scope_length")
    return str(row["robot"]) if length is None else f"{row['robot']} of {length:g} m"


def failures(rows: Sequence[dict[str, Any]]) -> str:
    """Return one line for each patient that was not passed, the shortest way first."""
    failed = sorted((row for row in rows if row["problem"]), key=lambda row: float(row["reached"]))
    return "\n".join(
        f"- {row['patient']}, {robot_of(row)}, {row['tissue']}: {row['reached']:.2f} of {row['length']:.2f} m, in the "
        f"{list(row['segments'])[-1]}, {row['problem']}; {row['held_by']}"
        for row in failed
    )


def _of_segment(rows: Sequence[dict[str, Any]], segment: str) -> tuple[str, ...]:
    entries = [row["segments"][segment] for row in rows if segment in row["segments"]]
    share = f"{len(entries)} of {len(rows)}"
    if not entries:
        return (share, *["–"] * 4)
    digits = {"time": 0, "tip_peak": 1, "window_peak": 1, "drive_peak": 1}
    figures = {name: np.percentile([entry[name] for entry in entries], [50, 95]) for name in digits}
    return (share, *(f"{figures[name][0]:.{n}f} ({figures[name][1]:.{n}f})" for name, n in digits.items()))
