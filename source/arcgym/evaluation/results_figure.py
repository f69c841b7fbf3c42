# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of the paper's table: success with its interval, and the paper's own figures. Needs matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arcgym.evaluation.results import Result
from arcgym.evaluation.results_page import cells_of, published_figures
from arcgym.evaluation.statistics import wilson

COLORS = 32
"""Colors of the picture: a palette takes a quarter of the bytes."""


def draw_results(results: Sequence[Result], section: dict[str, Any], out: Path) -> None:
    """Draw a panel a segment and a line a robot and method that has a result; the paper's figures are hollow.

    Args:
        results: What can be shown.
        section: A section of kind ``methods``.
        out: Picture to write.
    """
    from matplotlib.figure import Figure
    from PIL import Image

    own = [one for one in results if one.suite == section["suite"]]
    rows = [row for row in cells_of(section, own) if any(row[2])]
    size = (2.4 * len(section["segments"]) + 3.2, 0.26 * max(len(rows), 2) + 1.3)
    figure = Figure(figsize=size, layout="constrained")
    panels: Any = figure.subplots(1, len(section["segments"]), sharey=True, squeeze=False)[0]
    for column, (axes, segment) in enumerate(zip(panels, section["segments"], strict=True)):
        for place, (robot, method, found) in enumerate(rows):
            published = published_figures(section, robot, method)
            if published is not None:
                axes.plot(published[column], place, "D", mfc="none", mec="0.5", ms=6)
            result = found[column]
            if result is not None:
                _point(axes, place, result)
        axes.set(xlim=(-4, 104), ylim=(max(len(rows), 1) - 0.5, -0.5), title=segment, xlabel="success [%]")
        axes.grid(alpha=0.3)
    labels = [f"{robot}: {section['labels'][method]}" for robot, method, _ in rows]
    panels[0].set_yticks(range(len(rows)), labels, fontsize=7)
    figure.suptitle("30 trials on colon 1, with 95 % intervals; hollow: the paper's own figure", fontsize=9)
    out.parent.mkdir(parents=True, exist_ok=True)
    whole = io.BytesIO()
    figure.savefig(whole, format="png", dpi=80)
    Image.open(whole).convert("RGB").quantize(COLORS).save(out, format="PNG", optimize=True)


def _point(axes: Any, place: int, result: Result) -> None:
    """Draw a success rate with Wilson's interval [%]."""
    rate = wilson(sum(row["success"] for row in result.rows), len(result.rows))
    error = [[100 * (rate.value - rate.low)], [100 * (rate.high - rate.value)]]
    axes.errorbar(100 * rate.value, place, xerr=error, fmt="o", capsize=3, ms=4, color="C0")
