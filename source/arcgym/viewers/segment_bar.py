# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bar of the colon's segments with the tip's place and the task's range."""

from __future__ import annotations

from PIL import ImageDraw

from arcgym.viewers.drawing import DARK, INK, Box, Color, first_fitting, font, mix
from arcgym.viewers.palette import SEGMENT_COLORS

_TEXT_SIZES = (13, 11, 10)
_GOAL: Color = (255, 255, 255)
_UNKNOWN: Color = (120, 126, 136)


def draw_segment_bar(
    draw: ImageDraw.ImageDraw,
    box: Box,
    bounds: dict[str, tuple[float, float]],
    tip_arc: float,
    task_range: tuple[float, float] | None = None,
) -> None:
    """Draw the bar into a box; everything drawn stays inside.

    Args:
        draw: Where to draw.
        box: The top quarter takes the tip's marker, the rest the bar.
        bounds: Start and end of each segment [m of arc length].
        tip_arc: Arc length of the tip [m].
        task_range: Start and goal of the task [m]; segments outside are dimmed. None: all are bright.
    """
    left, top, right, bottom = box
    marker = 0.28 * (bottom - top)
    length = max(end for _, end in bounds.values())

    def place(arc: float) -> float:
        return left + (right - left) * min(max(arc / length, 0.0), 1.0)

    for name, (start, end) in bounds.items():
        color = SEGMENT_COLORS.get(name, _UNKNOWN)
        if task_range and not task_range[0] < 0.5 * (start + end) < task_range[1]:
            color = mix(color, DARK, 0.55)
        _draw_segment(draw, (place(start), top + marker, place(end) - 2, bottom), name, color)
    if task_range:
        edges = (place(task_range[0]), top + marker, place(task_range[1]) - 2, bottom)
        draw.rounded_rectangle(edges, radius=3, outline=_GOAL, width=2)
    _draw_marker(draw, min(max(place(tip_arc), left + 7), right - 7), top, marker, bottom)


def _draw_segment(draw: ImageDraw.ImageDraw, box: Box, name: str, color: Color) -> None:
    left, top, right, bottom = box
    if right <= left:
        return
    draw.rounded_rectangle(box, radius=3, fill=color)
    ink = DARK if sum(color) > 330 else INK
    for size in _TEXT_SIZES:
        text = first_fitting(draw, (name, f"{name[:3]}.", name[:3]), right - left - 2, size)
        if text:
            draw.text((0.5 * (left + right), 0.5 * (top + bottom)), text, fill=ink, font=font(size), anchor="mm")
            return


def _draw_marker(draw: ImageDraw.ImageDraw, x: float, top: float, height: float, bottom: float) -> None:
    draw.polygon([(x - 7, top), (x + 7, top), (x, top + height + 3)], fill=INK, outline=DARK)
    draw.line([(x, top + height), (x, bottom)], fill=DARK, width=3)
    draw.line([(x, top + height), (x, bottom)], fill=INK, width=1)
