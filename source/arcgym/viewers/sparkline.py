# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small line chart of the last seconds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import ImageDraw

from arcgym.viewers.drawing import DIM_INK, PANEL, Box, Color, first_fitting, font, mix

_TEXT_SIZE = 12
_PAD = 5


def draw_sparkline(
    draw: ImageDraw.ImageDraw,
    box: Box,
    values: Sequence[float],
    label: str,
    color: Color,
    floor: tuple[float, float],
    thresholds: Sequence[tuple[float, Color]] = (),
    capacity: int = 100,
) -> None:
    """Draw the newest value at the right end; the chart scrolls to the left once `capacity` values are there.

    Args:
        draw: Where to draw.
        box: Everything drawn stays inside.
        values: Oldest first; values that are not finite leave a gap.
        label: Drawn in the upper left corner if it fits.
        color: Color of the line.
        floor: Lowest and highest value that the axis always covers.
        thresholds: Values and colors of horizontal lines, drawn where they lie on the axis.
        capacity: Number of values that fill the width.
    """
    left, top, right, bottom = box
    draw.rounded_rectangle(box, radius=4, fill=PANEL)
    title = first_fitting(draw, (label,), right - left - 2 * _PAD, _TEXT_SIZE)
    draw.text((left + _PAD, top + 2), title, fill=DIM_INK, font=font(_TEXT_SIZE))
    shown = np.asarray(values, float)[-capacity:]
    finite = shown[np.isfinite(shown)]
    low, high = min([floor[0], *finite]), max([floor[1], *finite])
    plot = (left + _PAD, top + _TEXT_SIZE + 7, right - _PAD, bottom - _PAD)

    def height(value: float) -> float:
        return plot[3] - (plot[3] - plot[1]) * (value - low) / (high - low)

    for value, line_color in [(0.0, DIM_INK), *thresholds]:
        if low <= value <= high:
            draw.line([(plot[0], height(value)), (plot[2], height(value))], fill=mix(line_color, PANEL, 0.6), width=1)
    step = (plot[2] - plot[0]) / max(capacity - 1, 1)
    points = [(plot[0] + step * k, height(v)) if np.isfinite(v) else None for k, v in enumerate(shown)]
    for a, b in zip(points, points[1:], strict=False):
        if a and b:
            draw.line([a, b], fill=color, width=2)
    if points and points[-1]:
        x, y = points[-1]
        draw.ellipse((x - 2.5, y - 2.5, x + 2.5, y + 2.5), fill=color)
