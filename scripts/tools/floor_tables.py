#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make the tables of ``docs/evaluation.md`` from result folders, between its two marks.

A task is shown of the agents that have run all of its trials, or all of a share (each n-th, ``--share 1/n``): those
that end early come first, so that another part would be another sample.

python scripts/tools/floor_tables.py results --commit 1e655ad           # prints them
python scripts/tools/floor_tables.py results --commit 1e655ad --write   # writes them into the page
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.evaluation.result_folder import RUN_FILE, read_run, read_trial_rows
from arcgym.evaluation.statistics import Interval
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.summary import summarize
from arcgym.evaluation.trials import read_conditions

PAGE = Path(__file__).resolve().parents[2] / "docs" / "evaluation.md"
BEGIN, END = "<!-- floor -->", "<!-- end of floor -->"

AGENTS = ("zero", "random", "expert")
"""Agents in the order of the rows."""

LARGEST_SHARE = 10
"""Shares of the trials that are shown: all of them to each tenth one."""

COLUMNS = {
    "progress": ("progress", 2),
    "seconds": ("time [s]", 1),
    "p95_tip_force": ("p95 tip force [N]", 2),
    "p95_shaft_force": ("p95 shaft force [N]", 2),
    "looping_ratio": ("looping ratio", 2),
    "path_efficiency": ("path efficiency", 2),
    "coverage": ("coverage", 2),
}
"""Heading and digits of the metrics that are shown, where rows have them."""


def main() -> None:
    """Parse the command line, and print the tables or write them into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder with result folders in it")
    parser.add_argument("--commit", help="commit that was run, where the folders do not say it")
    parser.add_argument("--write", action="store_true", help="write the tables into docs/evaluation.md")
    args = parser.parse_args()
    text = tables(sorted(path.parent for path in args.folder.glob(f"*/{RUN_FILE}")), args.commit)
    if not args.write:
        print(text)
        return
    page = PAGE.read_text()
    PAGE.write_text(f"{page[: page.index(BEGIN) + len(BEGIN)]}\n{text}{page[page.index(END) :]}")


def tables(folders: Sequence[Path], commit: str | None) -> str:
    """Return a table a suite, in the suites' order, with what was run where."""
    runs = [(read_run(folder), read_trial_rows(folder)) for folder in folders]
    runs = [(run, rows) for run, rows in runs if run["agent"] in AGENTS and rows]
    parts = [f"{_origin([run for run, _ in runs], commit)}\n"]
    for name, suite in read_suites().items():
        numbers = [trial.trial for trial in read_conditions(suite.conditions_path).trials]
        rows = _whole([row for run, rows in runs if run["suite"] == name for row in rows], numbers)
        if rows:
            parts.append(f"**`{name}`**\n\n{_table(rows)}")
    return "\n".join(parts)


def _whole(rows: Sequence[dict[str, Any]], numbers: Sequence[int]) -> list[dict[str, Any]]:
    """Return the rows of the agents and tasks that have all trials, or each n-th of them from the first on."""
    shares = [set(numbers[::n]) for n in range(1, LARGEST_SHARE + 1)]
    done: dict[tuple[str, str], set[int]] = {}
    for row in rows:
        done.setdefault((row["task"], row["agent"]), set()).add(row["trial"])
    return [row for row in rows if done[row["task"], row["agent"]] in shares]


def _origin(runs: Sequence[dict[str, Any]], commit: str | None) -> str:
    machines = ", ".join(sorted({run["machine"] for run in runs}))
    commits = ", ".join(sorted({run["versions"].get("arcgym commit", commit or "?") for run in runs}))
    return (
        f"Machine: {machines}; commit {commits}. Success with Wilson's interval, the rest interquartile means with "
        "bootstrap intervals over the trials, all at 95 %."
    )


def _table(rows: Sequence[dict[str, Any]]) -> str:
    by_agent: dict[str, dict[str, Any]] = {
        agent: summarize([row for row in rows if row["agent"] == agent])
        for agent in AGENTS
        if any(row["agent"] == agent for row in rows)
    }
    names = [name for name in COLUMNS if any(name in of for all_ in by_agent.values() for of in all_.values())]
    head = ["task", "agent", "trials", "success [%]", *(COLUMNS[name][0] for name in names)]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for task in sorted({task for of in by_agent.values() for task in of}):
        for agent in by_agent:
            if task in by_agent[agent]:
                lines.append(_line(task, agent, by_agent[agent][task], names))
    return "\n".join(lines) + "\n"


def _line(task: str, agent: str, of: dict[str, Any], names: Sequence[str]) -> str:
    cells = [_cell(of[name], COLUMNS[name][1]) if name in of else "" for name in names]
    success = _cell(of["success"], 0, factor=100.0)
    return f"| {' | '.join([f'`{task}`', agent, str(of['trials']), success, *cells])} |"


def _cell(value: Interval, digits: int, factor: float = 1.0) -> str:
    return f"{factor * value.value:.{digits}f} ({factor * value.low:.{digits}f}–{factor * value.high:.{digits}f})"


if __name__ == "__main__":
    main()
