# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Pictures of a study: its curves, and success against time above ``unsafe``. Needs matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.studies.cell import Cell
from arcgym.studies.curves import read_curves
from arcgym.studies.table import cell_rows

PANELS = (
    ("transitions", 1.0e-6, "transitions [million]", "success", "success in training"),
    ("seconds", 1.0 / 60.0, "wall time of learning [min]", "success", "success in training"),
    ("transitions", 1.0e-6, "transitions [million]", "reward", "reward an episode"),
    ("seconds", 1.0 / 60.0, "wall time of learning [min]", "reward", "reward an episode"),
)
"""Abscissa, its factor and label, ordinate and its label, a column of panels each."""

SMOOTHED = 20
"""A curve is drawn as a running mean over this fraction of its points: a twentieth."""


def variant(cell: Cell) -> str:
    """Return what tells a curve from others of the same task: algorithm and further axes, but not the seed."""
    varied = [f"{name.rpartition('.')[2]}={value}" for name, value in cell.axes.items()]
    return " ".join([cell.algorithm, *varied])


def draw_curves(cells: Sequence[Cell], out: Path, title: str = "") -> None:
    """Draw a row of panels a task; seeds of a variant have its color, one thin line each."""
    from matplotlib.figure import Figure

    tasks = sorted({cell.task for cell in cells})
    colors = _colors(cells)
    fig = Figure(figsize=(4.2 * len(PANELS), 3.0 * len(tasks) + 0.9), layout="constrained")
    axes: Any = fig.subplots(len(tasks), len(PANELS), squeeze=False)
    for row, task in enumerate(tasks):
        for axis, (x_name, factor, x_label, y_name, y_label) in zip(axes[row], PANELS, strict=True):
            for cell in (cell for cell in cells if cell.task == task):
                x, y = _curve(cell, x_name, y_name)
                axis.plot(factor * x, y, color=colors[variant(cell)], linewidth=1.4)
            axis.set(xlabel=x_label, ylabel=y_label, title=task.removeprefix("ARC-"))
            axis.grid(alpha=0.3)
            if y_name == "success":
                axis.set_ylim(-0.02, 1.02)
    _legend(fig, colors)
    fig.suptitle(title)
    fig.savefig(out, dpi=110)


def draw_pareto(cells: Sequence[Cell], out: Path, title: str = "") -> None:
    """Draw success against the time that tip and shaft press above ``unsafe``, a point a cell, a panel a task."""
    from matplotlib.figure import Figure

    tasks = sorted({cell.task for cell in cells})
    colors = _colors(cells)
    fig = Figure(figsize=(4.6 * len(tasks), 4.4), layout="constrained")
    axes: Any = fig.subplots(1, len(tasks), squeeze=False)[0]
    for axis, task in zip(axes, tasks, strict=True):
        for cell in (cell for cell in cells if cell.task == task):
            for row in cell_rows(cell):
                if row["success %"] != "":
                    filled = colors[variant(cell)] if row["algorithm"] == cell.algorithm else "none"
                    axis.scatter(
                        row["tip > unsafe s"], row["success %"], color=filled, edgecolors=colors[variant(cell)], s=45
                    )
        axis.set(
            xlabel="mean time of an episode with tip force above unsafe [s]", ylabel="success of first episodes [%]"
        )
        axis.set(title=task.removeprefix("ARC-"), ylim=(-3, 103))
        axis.set_xlim(left=min(0.0, axis.get_xlim()[0]))
        axis.grid(alpha=0.3)
    _legend(fig, colors)
    fig.suptitle(title)
    fig.savefig(out, dpi=110)


def _curve(cell: Cell, x_name: str, y_name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return a curve of a cell, smoothed."""
    rows = [row for row in read_curves(cell) if row.get(x_name, "") != "" and row.get(y_name, "") != ""]
    x, y = (np.array([row[name] for row in rows], dtype=float) for name in (x_name, y_name))
    width = max(len(y) // SMOOTHED, 1)
    if len(y) == 0:
        return x, y
    padded = np.concatenate([np.full(width - 1, y[0]), y])
    return x, np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def _colors(cells: Sequence[Cell]) -> dict[str, Any]:
    """Return a color for each variant."""
    from matplotlib import colormaps

    names = list(dict.fromkeys(variant(cell) for cell in cells))
    palette = colormaps["tab10" if len(names) <= 10 else "tab20"]
    return {name: palette(index % palette.N) for index, name in enumerate(names)}


def _legend(fig: Any, colors: dict[str, Any]) -> None:
    """Name the variants below the panels, in as many columns as fit."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=color, label=name) for name, color in colors.items()]
    width = 0.5 + 0.09 * max(map(len, colors))
    columns = max(1, min(len(lines), int(fig.get_figwidth() / width)))
    fig.legend(handles=lines, loc="outside lower center", ncols=columns, frameon=False)
