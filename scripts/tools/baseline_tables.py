#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make the tables of ``docs/baselines.md`` from ``docs/data/baselines.csv``, between its two marks.

Result folders that are given are taken into the file first. A task is shown of the agents that have run all of its
trials, or all of a share (each n-th, ``--share 1/n``): those that end early come first, so that another part would be
another sample. What the file has already stays, but for what was run again with at least as many trials.

python scripts/tools/baseline_tables.py                   # prints the tables
python scripts/tools/baseline_tables.py results           # and those with the folders below results
python scripts/tools/baseline_tables.py results --write   # writes both files
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from arcgym.evaluation.baselines import FIGURES, Baseline, baselines_of, read_baselines, updated, write_baselines
from arcgym.evaluation.results import find_results
from arcgym.evaluation.statistics import Interval
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE, BASELINES = DOCS / "baselines.md", DOCS / "data" / "baselines.csv"
BEGIN, END = "<!-- baselines -->", "<!-- end of baselines -->"

INTRODUCTION = """Success with Wilson's interval, the rest interquartile means with bootstrap intervals over the trials,
all at 95 %. Below each table: what ran it. The same rows, for programs: `docs/data/baselines.csv`.
"""


def main() -> None:
    """Parse the command line, and print the tables or write them into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="*", help="folders with result folders in them")
    parser.add_argument(
        "--baselines", type=Path, default=BASELINES, help="file with the rows (docs/data/baselines.csv)"
    )
    parser.add_argument("--write", action="store_true", help="write the rows, and the tables into docs/baselines.md")
    args = parser.parse_args()
    results, left_out = find_results(args.folders)
    for path, reasons in left_out.items():
        print(f"left out: {path}: {'; '.join(reasons)}")
    baselines = updated(read_baselines(args.baselines), baselines_of(results))
    text = tables(baselines)
    if not args.write:
        print(text, end="")
        return
    write_baselines(args.baselines, baselines)
    text = tables(read_baselines(args.baselines))  # of the digits in the file, so that the page is made again from it
    page = PAGE.read_text()
    PAGE.write_text(f"{page[: page.index(BEGIN) + len(BEGIN)]}\n{text}{page[page.index(END) :]}")


def tables(baselines: Sequence[Baseline]) -> str:
    """Return a table a suite, in the order of the rows, with what was run where."""
    parts = [INTRODUCTION]
    for suite in dict.fromkeys(one.suite for one in baselines):
        own = [one for one in baselines if one.suite == suite]
        parts.append(f"**`{suite}`**\n\n{_table(own)}\n{_origin(own)}")
    return "\n".join(parts)


def _table(baselines: Sequence[Baseline]) -> str:
    names = [name for name in FIGURES if any(name in one.figures for one in baselines)]
    head = ["task", "agent", "trials", *(FIGURES[name][0] for name in names)]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for one in baselines:
        cells = [_cell(one.figures[name], name) if name in one.figures else "" for name in names]
        lines.append(f"| {' | '.join([f'`{one.task}`', one.agent, str(one.trials), *cells])} |")
    return "\n".join(lines) + "\n"


def _cell(of: Interval, name: str) -> str:
    digits, factor = FIGURES[name][1], 100.0 if name == "success" else 1.0
    return f"{factor * of.value:.{digits}f} ({factor * of.low:.{digits}f}–{factor * of.high:.{digits}f})"


def _origin(baselines: Sequence[Baseline]) -> str:
    """Return commit, machine and trials of the rows, with their names where there are several."""
    groups: dict[tuple[str, str], list[Baseline]] = {}
    suites = read_suites()
    for one in baselines:
        about = one.machine
        if one.conditions != suites[one.suite].conditions:
            about += f"; trials of {one.conditions}, an earlier version"
        if not one.is_of_present_steps:
            about += f"; physics steps of {PHYSICS_STEP.as_text(one.physics_hz)}, an earlier default"
        if not one.is_of_present_patience:
            about += f"; stuck after {PATIENCE.as_text(one.stuck_after_s)}, an earlier default"
        groups.setdefault((one.commit, about), []).append(one)
    if len(groups) == 1:
        return "Commit {}; {}.\n".format(*next(iter(groups)))
    several = len({one.task for one in baselines}) > 1
    parts = []
    for (commit, machine), own in groups.items():
        names = ", ".join(f"`{one.task}` {one.agent}" if several else one.agent for one in own)
        parts.append(f"{names}: commit {commit}; {machine}.")
    return " ".join(parts) + "\n"


if __name__ == "__main__":
    main()
