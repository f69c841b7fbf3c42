# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Table of a study, a row a cell, from the first episode of each of its worlds."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.rl.evaluation import EPISODES_FILE, WITHOUT_RULES
from arcgym.rl.first_episodes import read_rows, write_rows
from arcgym.studies.cell import Cell
from arcgym.studies.curves import read_curves
from arcgym.utils.files import write_whole

MEANS = {
    "progress": "progress",
    "episode s": "seconds",
    "reward": "reward",
    "tip > unsafe s": "tip_time_above_unsafe",
    "largest tip N": "max_tip_force",
    "shaft > unsafe s": "shaft_time_above_unsafe",
    "s_c": "s_c",
    "ROI rate": "centered_rate",
}
"""Heading and column of what is averaged over the episodes."""


def cell_rows(cell: Cell) -> list[dict[str, Any]]:
    """Return a cell's row of the table, and another one for its policy without rules on its actions."""
    curves = read_curves(cell)
    last = curves[-1] if curves else {}
    base: dict[str, Any] = {"task": cell.task, "algorithm": cell.algorithm, "seed": cell.seed}
    base |= {_heading(name): value for name, value in cell.axes.items()}
    base |= {"state": cell.read_state()["state"], "iterations": len(curves)}
    base |= {"transitions": last.get("transitions", ""), "minutes": _minutes(last.get("seconds"))}
    rows = []
    for prefix in ("", WITHOUT_RULES):
        path = newest(cell, f"{prefix}{EPISODES_FILE}")
        if path is not None or not prefix:
            label = f"{cell.algorithm}, rules off" if prefix else cell.algorithm
            rows.append({**base, "algorithm": label, **summary(read_rows(path) if path else [])})
    return rows


def _heading(axis: str) -> str:
    """Return the last part of an axis' path, or all of it where a figure has that name, such as ``env.reward``."""
    short = axis.rpartition(".")[2]
    return axis if short in MEANS else short


def summary(episodes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return number, success rate and means of some episodes; empty texts where there is none."""
    result: dict[str, Any] = {"episodes": len(episodes)}
    result["success %"] = round(100.0 * statistics.fmean(row["success"] for row in episodes), 1) if episodes else ""
    arrived = [row["seconds"] for row in episodes if row["success"]]
    result["arrival s"] = round(statistics.fmean(arrived), 2) if arrived else ""
    for heading, column in MEANS.items():
        has = bool(episodes) and column in episodes[0]
        result[heading] = round(statistics.fmean(row[column] for row in episodes), 3) if has else ""
    for column in episodes[0] if episodes else ():
        if column.startswith("cost_"):
            result[column.replace("_", " ")] = round(statistics.fmean(row[column] for row in episodes), 3)
    return result


def newest(cell: Cell, name: str) -> Path | None:
    """Return the file of that name of the cell's last run that has one."""
    found = [run / name for run in reversed(cell.runs) if (run / name).is_file()]
    return found[0] if found else None


def write_table(study: Path, cells: Sequence[Cell]) -> list[dict[str, Any]]:
    """Write ``table.csv``, ``table.md`` and ``episodes.csv`` to a study's folder, and return the table's rows.

    ``table.md`` also has the end of the log of each cell that failed. ``episodes.csv`` has all episodes.
    """
    rows = [row for cell in cells for row in cell_rows(cell)]
    names = list(dict.fromkeys(name for row in rows for name in row))
    rows = [{name: row.get(name, "") for name in names} for row in rows]
    write_rows(study / "table.csv", rows)
    write_rows(study / "episodes.csv", all_episodes(cells))
    text = f"# Study {study.name}\n\n{_markdown(rows, names)}\n{_failures(cells)}"
    write_whole(study / "table.md", text.encode())
    return rows


def all_episodes(cells: Sequence[Cell]) -> list[dict[str, Any]]:
    """Return the first episodes of all cells, each with its cell's name."""
    rows = []
    for cell in cells:
        for prefix in ("", WITHOUT_RULES):
            path = newest(cell, f"{prefix}{EPISODES_FILE}")
            about = {"cell": cell.name, "rules": "off" if prefix else ""}
            rows += [{**about, **row} for row in (read_rows(path) if path else [])]
    names = list(dict.fromkeys(name for row in rows for name in row))
    return [{name: row.get(name, "") for name in names} for row in rows]


def _markdown(rows: Sequence[dict[str, Any]], names: Sequence[str]) -> str:
    lines = [names, ["---"] * len(names), *([_text(row[name]) for name in names] for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _failures(cells: Sequence[Cell]) -> str:
    """Return a section on the cells that failed, with the end of their logs."""
    failed = {cell.name: cell.read_state() for cell in cells if cell.read_state()["state"] == "failed"}
    if not failed:
        return ""
    parts = [
        f"## {name}: exit status {state['status']}\n\n```text\n{state['log']}\n```\n" for name, state in failed.items()
    ]
    return "\n" + "\n".join(parts)


def _minutes(seconds: Any) -> Any:
    return round(seconds / 60.0, 2) if isinstance(seconds, (int, float)) else ""
