#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make tables, and a file of all rows, from folders of ``arcgym bench experts``.

Rows of a patient, robot and tissue count once, that of the last folder; drives that computing time ended count with how
far they came.

python scripts/tools/expert_tables.py logs/experts ...                      # prints the tables
python scripts/tools/expert_tables.py logs/experts ... --write experts.csv --commit 5aa95b2   # and writes the rows

Rows of other patients, robots and tissues that the file has stay there.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.benchmarks.experts.table import failures, read_rows, robot_of, table
from arcgym.evaluation.statistics import wilson

FORCES = ("tip_peak", "window_peak", "drive_peak")
REACHED = ("past the splenic flexure [%]", "to the cecum [%]")
HEADINGS = ("robot", "tissue", *REACHED, "time [s]", "tip [N]", "50 mm of scope [N]", "drive [N]")


def main() -> None:
    """Parse the command line, print the tables and write the rows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+", help="folders with rows.jsonl")
    parser.add_argument("--write", type=Path, help="file of the rows")
    parser.add_argument("--commit", default="", help="what drove them, for the file's last column")
    args = parser.parse_args()
    rows = gathered(args.folders)
    print(summary(rows), table(rows), failures(rows), sep="\n\n")
    if args.write:
        write(rows, args.write, args.commit)


def gathered(folders: Sequence[Path]) -> list[dict[str, Any]]:
    """Return the last row of each patient, robot and tissue; one of a drive that was cut off if there is no other."""
    found: dict[tuple[str, ...], dict[str, Any]] = {}
    for name in ("unfinished.jsonl", "rows.jsonl"):
        for folder in folders:
            for row in read_rows(folder / name):
                found[robot_of(row), row["tissue"], row["patient"]] = row
    return [found[key] for key in sorted(found)]


def summary(rows: Sequence[dict[str, Any]]) -> str:
    """Return a table of what was reached; times and forces on the way to the cecum, median (95th percentile)."""
    lines = [f"| {' | '.join(HEADINGS)} |", "|---" * len(HEADINGS) + "|"]
    for robot, tissue in dict.fromkeys((robot_of(row), row["tissue"]) for row in rows):
        own = [row for row in rows if (robot_of(row), row["tissue"]) == (robot, tissue)]
        ends = [row["segments"]["cecum"] for row in own if "cecum" in row["segments"]]
        cells = [robot, tissue, *(_share(own, segment) for segment in ("transverse", "cecum"))]
        cells += [_spread(ends, name, digits) for name, digits in {"time": 0, **dict.fromkeys(FORCES, 1)}.items()]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def write(rows: Sequence[dict[str, Any]], path: Path, commit: str = "") -> None:
    """Write one line a patient, robot and tissue into a file, beside those that it has of others."""
    names = ["patient", "robot", "tissue", "scope_m", "length_m", "reached_m", "time_s", "last_segment"]
    names += ["tip_peak_N", "window_peak_N", "drive_peak_N", "inserted_m", "problem", "held_by", "commit"]
    lines: dict[tuple[str, ...], list[str]] = {}
    if path.is_file():
        with path.open(newline="") as file:
            _, *before = csv.reader(file)
        lines = {(line[1], line[2], line[0]): line for line in before}
    for row in rows:
        line = [*_line(row), commit]
        lines[line[1], line[2], line[0]] = line
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(lines[key] for key in sorted(lines))


def _line(row: dict[str, Any]) -> list[str]:
    segment, entry = list(row["segments"].items())[-1] if row["segments"] else ("rectum", {})
    forces = [f"{entry[name]:.1f}" if entry else "" for name in FORCES]
    inserted = f"{entry['inserted']:.2f}" if entry and row["robot"] != "capsule" else ""
    scope = str(row.get("scope_length") or "")
    about = [row["patient"].removeprefix("patient_"), row["robot"], row["tissue"], scope]
    way = [f"{row['length']:.2f}", f"{row['reached']:.2f}", f"{row['time']:.0f}", segment]
    ended = [row["problem"] or "", row["held_by"] if row["problem"] else ""]
    return [*about, *way, *forces, inserted, *ended]


def _share(rows: Sequence[dict[str, Any]], segment: str) -> str:
    there = sum(segment in row["segments"] for row in rows)
    bounds = wilson(there, len(rows))
    return f"{100 * there / len(rows):.0f} ({100 * bounds.low:.0f}–{100 * bounds.high:.0f})"


def _spread(entries: Sequence[dict[str, float]], name: str, digits: int) -> str:
    if not entries:
        return "–"
    median, high = np.percentile([entry[name] for entry in entries], [50, 95])
    return f"{median:.{digits}f} ({high:.{digits}f})"


if __name__ == "__main__":
    main()
