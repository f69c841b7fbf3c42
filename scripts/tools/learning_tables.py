#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make the tables and pictures of ``docs/agents_compared.md`` from the studies' results in ``docs/data``.

python scripts/tools/learning_tables.py take keys logs/studies/keys --commit 1e655ad   # a study's cells into the data
python scripts/tools/learning_tables.py write                                          # tables into the page, pictures
"""

from __future__ import annotations

import argparse
import json
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.evaluation.statistics import wilson
from arcgym.studies.cell import Cell, read_cells
from arcgym.studies.curves import read_curves
from arcgym.studies.table import cell_rows

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "agents_compared.md"
TASKS = ("ARC-Rectum-Magnetic", "ARC-Splenic-Proximal", "ARC-Sigmoid-Magnetic")
AGENTS = {
    "ppo": "`ppo`",
    "ppo_recurrent": "`ppo_recurrent`",
    "ppo_masked": "`ppo_masked`",
    "ppo_masked, rules off": "the same, rules off",
    "ppo_lagrangian": "`ppo_lagrangian`",
    "a2c": "`a2c`",
    "a2c_falling": "`a2c`, falling rate",
    "sac": "`sac`",
    "ppo_teacher": "`ppo_teacher` (privileged state)",
    "distillation": "`distillation`",
    "bc": "`bc` (from the expert)",
}
"""Agents in the order of the rows, and how the page calls them."""

TIP = {
    "clone": "a clone of the expert, as all start from (c78097c, 64 worlds)",
    "no_limit": "no limit (`ppo`)",
    "limit_1": "limit of 1 s",
    "limit_0.3": "limit of 0.3 s",
    "limit_0.1": "limit of 0.1 s",
    "penalty": "fixed penalty of 1",
    "early_end": "early end after 0.3 s",
}
LIMITS = {"limits": (TIP, "tip")}
"""Studies of limits: their cells, and what presses."""

MARKS = ("", "†", "‡", "§", "¶")
"""Marks of commits, the most frequent one first."""

CURVES = ("transitions", "seconds", "success", "reward", "progress")
COSTS = ("cost_tip_force", "cost_shaft_force", "multiplier/tip_force", "multiplier/shaft_force")
FEW = 16
"""Episodes up to which a share is given as a fraction and not in percent."""


def main() -> None:
    """Parse the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    taking = commands.add_parser("take", help="put a study's cells into the data, in place of the same cells")
    taking.add_argument("data", choices=("keys", *LIMITS))
    taking.add_argument("study", type=Path, help="folder of the study")
    taking.add_argument("--commit", required=True, help="commit that was run")
    commands.add_parser("write", help="write the tables into docs/agents_compared.md and draw the pictures")
    args = parser.parse_args()
    if args.command == "take":
        take(data_file(args.data), args.study, args.commit)
        return
    keys = json.loads(data_file("keys").read_text())
    page = replaced(PAGE.read_text(), "keys", keys_table(keys["rows"]))
    limits = {name: json.loads(data_file(name).read_text()) for name in LIMITS}
    for name, data in limits.items():
        page = replaced(page, name, limits_table(data, *LIMITS[name]))
    PAGE.write_text(page)
    draw_keys(keys, DOCS / "images" / "learning_keys.png")
    draw_limits(limits, DOCS / "images" / "learning_limits.png")


def data_file(name: str) -> Path:
    """Return the file of the data of that name."""
    return DOCS / "data" / f"learning_{name}.json"


def take(path: Path, study: Path, commit: str) -> None:
    """Put the judged cells of a study into a file of data."""
    data = json.loads(path.read_text())
    for cell in read_cells(study):
        rows = [row for row in cell_rows(cell) if row["episodes"]]
        if not rows:
            print(f"{cell.name}: not judged, left out")
            continue
        new = {identity(row) for row in rows}
        data["rows"] = [row for row in data["rows"] if identity(row) not in new]
        data["rows"] += [row | {"commit": commit} for row in rows]
        data["curves"][curve_name(cell.task, cell.algorithm)] = curves(cell)
        print(f"{cell.name}: {rows[0]['success %']} % of {rows[0]['episodes']}")
    path.write_text(json.dumps(data))


def identity(row: dict[str, Any]) -> tuple[Any, ...]:
    """Return what tells a row from the others."""
    return row["task"], row["algorithm"], row["seed"]


def curve_name(task: str, algorithm: str) -> str:
    """Return the name of a cell's curves."""
    return f"{task.removeprefix('ARC-').lower()}_{algorithm}"


def curves(cell: Cell) -> dict[str, list[float | None]]:
    """Return the curves of a cell, None where an iteration has no value."""
    rows = read_curves(cell)
    found = [name for name in CURVES + COSTS if any(row.get(name, "") != "" for row in rows)]
    return {n: [round(float(row[n]), 4) if row.get(n, "") != "" else None for row in rows] for n in found}


def keys_table(rows: Sequence[dict[str, Any]]) -> str:
    """Return the table of the agents on the three tasks, and the line that says what its marks mean."""
    commits = [row["commit"] for row in rows]
    marks = dict(zip(sorted(set(commits), key=commits.count, reverse=True), MARKS, strict=False))
    head = "".join(f" {task.removeprefix('ARC-')} | transitions |" for task in TASKS)
    lines = [f"| agent |{head}", f"|---|{'---:|---:|' * len(TASKS)}"]
    for agent, label in AGENTS.items():
        found = [
            next((row for row in rows if row["task"] == task and row["algorithm"] == agent), None) for task in TASKS
        ]
        if any(found):
            lines.append(f"| {label} |{''.join(keys_cells(row, marks) for row in found)}")
    told = "; ".join(f"{mark} commit {commit}" if mark else f"Commit {commit}" for commit, mark in marks.items())
    return "\n".join([*lines, "", f"{told}."])


def keys_cells(row: dict[str, Any] | None, marks: dict[str, str]) -> str:
    """Return the two cells of an agent on a task."""
    if row is None:
        return " | |"
    way = f" ({row['arrival s']:.1f} s)" if row["arrival s"] != "" else f", {100 * row['progress']:.0f} % of the way"
    count = "" if row["algorithm"].endswith("off") else f"{int(row['transitions']):,}".replace(",", " ")
    return f" {share(row)}{way} {marks[row['commit']]}".rstrip() + f" | {count} |"


def share(row: dict[str, Any]) -> str:
    """Return the share of successes in words."""
    if row["episodes"] <= FEW:
        return f"{round(row['success %'] * row['episodes'] / 100)} of {row['episodes']}"
    return f"{row['success %']:g} %"


def limits_table(data: dict[str, Any], labels: dict[str, str], part: str) -> str:
    """Return the table of limits on the time that tip or shaft press unsafely, and of their controls."""
    heads = ["transitions", "updates", "success (95 % interval)", f"{part} above unsafe, s an episode", "arrival, s"]
    lines = [f"| | {' | '.join([*heads, 'multiplier at the end (most)'])} |", f"|---|{'---:|' * 6}"]
    for name, label in labels.items():
        row = next((row for row in data["rows"] if row["algorithm"] == name), None)
        if row is not None:
            lines.append(f"| {label} | {' | '.join(limits_cells(row, data['curves'], part))} |")
    return "\n".join(lines)


def limits_cells(row: dict[str, Any], found: dict[str, Any], part: str) -> list[str]:
    """Return the cells of a row of :func:`limits_table`."""
    low, high = interval(row)
    curve = found.get(curve_name(row["task"], row["algorithm"]), {})
    prices = [price for price in curve.get(f"multiplier/{part}_force", []) if price]
    count = f"{int(row['transitions']):,}".replace(",", " ") if row["transitions"] != "" else ""
    cells = [count, str(row["iterations"]), f"{row['success %']:g} % ({low:.0f} to {high:.0f})"]
    cells += [f"{row[f'{part} > unsafe s']:.2f}", f"{row['arrival s']:.1f}" if row["arrival s"] != "" else ""]
    return [*cells, f"{prices[-1]:.1f} ({max(prices):.1f})" if prices else ""]


def interval(row: dict[str, Any]) -> tuple[float, float]:
    """Return the 95 % interval (Wilson) of a row's success [%]."""
    found = wilson(round(row["success %"] * row["episodes"] / 100.0), row["episodes"])
    return 100.0 * found.low, 100.0 * found.high


def replaced(page: str, name: str, text: str) -> str:
    """Return the page with other text between the two marks of a name."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    return f"{page[: page.index(begin) + len(begin)]}\n{text}\n{page[page.index(end) :]}"


def smooth(xs: Sequence[Any], ys: Sequence[Any], width: int) -> tuple[list[float], list[float]]:
    """Return the points that are there, each a mean of the last ones."""
    points = [(x, y) for x, y in zip(xs, ys, strict=True) if x is not None and y is not None]
    means = [statistics.fmean(y for _, y in points[max(0, i - width + 1) : i + 1]) for i in range(len(points))]
    return [x for x, _ in points], means


def save(figure: Any, out: Path) -> None:
    """Write a picture with 128 colors, a third of what all would take."""
    from PIL import Image

    figure.savefig(out, dpi=80)
    Image.open(out).convert("RGB").quantize(128).save(out, optimize=True)


def draw_keys(data: dict[str, Any], out: Path) -> None:
    """Draw success and reward of the agents over transitions and wall time, a row of panels a task."""
    import matplotlib.pyplot as plt

    panels = [("transitions", 1e-6, "success"), ("seconds", 1 / 60, "success"), ("transitions", 1e-6, "reward")]
    labels = {"transitions": "transitions [million]", "seconds": "wall time of learning [min]"}
    figure, axes = plt.subplots(len(TASKS), 3, figsize=(12, 8.2), layout="constrained")
    agents = [agent for agent in AGENTS if "off" not in agent]
    for row, task in zip(axes, TASKS, strict=True):
        for axis, (x, factor, y) in zip(row, panels, strict=True):
            for k, agent in enumerate(agents):
                curve = data["curves"].get(curve_name(task, agent))
                if curve and y in curve:
                    xs, ys = smooth(curve[x], curve[y], max(len(curve[x]) // 20, 1))
                    axis.plot([factor * v for v in xs], ys, color=f"C{k}", linewidth=1.4)
            axis.set(xlabel=labels[x], title=f"{task.removeprefix('ARC-')}: {y} in training")
            axis.grid(alpha=0.3)
    lines = [plt.Line2D([], [], color=f"C{k}", label=agent) for k, agent in enumerate(agents)]
    figure.legend(handles=lines, loc="outside lower center", ncols=5, frameon=False)
    save(figure, out)


def draw_limits(studies: dict[str, Any], out: Path) -> None:
    """Draw success against time above unsafe of the judged policies, and how their training went, a row a study."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(studies), 4, figsize=(15, 3.6 * len(studies)), squeeze=False, layout="constrained")
    for row, (name, data) in zip(axes, studies.items(), strict=True):
        labels, part = LIMITS[name]
        for k, (cell, label) in enumerate(labels.items()):
            draw_cell(row, data, cell, label, part, "k" if cell == "clone" else f"C{k}")
        titles = (
            "judged: mean action, 95 %",
            "success in training",
            f"{part} above unsafe in training, s",
            "multiplier",
        )
        for axis, title in zip(row, titles, strict=True):
            axis.set(xlabel="transitions [million]", title=title)
            axis.grid(alpha=0.3)
        row[0].set(
            xlabel=f"{part} above unsafe, s an episode", ylabel="success of first episodes [%]", ylim=(None, 103)
        )
    figure.legend(handles=axes[0, 0].get_legend_handles_labels()[0], loc="outside lower center", ncols=4, frameon=False)
    save(figure, out)


def draw_cell(axes: Sequence[Any], data: dict[str, Any], name: str, label: str, part: str, color: str) -> None:
    """Draw a cell's point and its curves, if it is there."""
    row = next((row for row in data["rows"] if row["algorithm"] == name), None)
    if row is None:
        return
    low, high = interval(row)
    x, y = row[f"{part} > unsafe s"], row["success %"]
    axes[0].errorbar(x, y, [[max(y - low, 0)], [max(high - y, 0)]], fmt="o", ms=7, color=color, label=label)
    curve = data["curves"].get(curve_name(row["task"], name), {})
    kinds = {"success": 5, f"cost_{part}_force": 5, f"multiplier/{part}_force": 1}
    for axis, (kind, width) in zip(axes[1:], kinds.items(), strict=True):
        if kind in curve:
            xs, ys = smooth(curve["transitions"], curve[kind], width)
            axis.plot([1e-6 * v for v in xs], ys, color=color)


if __name__ == "__main__":
    main()
