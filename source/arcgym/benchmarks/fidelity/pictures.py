# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the pictures of the checks. Needs matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
from PIL import Image

from arcgym.benchmarks.fidelity.rows import Plot

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def draw(plots: Sequence[Plot], folder: Path) -> list[Path]:
    """Draw each plot into ``folder/<name>.png`` and return the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    return [draw_one(plot, folder / f"{plot.name}.png") for plot in plots]


def draw_one(plot: Plot, path: Path) -> Path:
    """Draw published ranges as bands, references as lines and the shipped solver as points."""
    figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
    for label, x, low, high in plot.bands:
        axes.fill_between(x, low, high, label=label, color="0.85", linewidth=0.0)
    for label, x, y in plot.lines:
        axes.plot(x, y, label=label, linewidth=1.2)
    for label, x, y in plot.points:
        axes.plot(x, y, "o", label=label, markersize=3.5, fillstyle="none")
    axes.set_xlabel(plot.x_label)
    axes.set_ylabel(plot.y_label)
    if plot.y_limit is not None:
        axes.set_ylim(0.0, plot.y_limit)
    axes.legend(frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)
    Image.open(path).quantize(64, dither=Image.Dither.NONE).save(path, optimize=True)  # a quarter of the size
    return path
