# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Everything that is written and drawn around the two pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from arcgym.viewers.drawing import DARK, DIM_INK, INK, Box, Color, font, text_width
from arcgym.viewers.frame_info import FrameInfo
from arcgym.viewers.palette import FORCE_TIERS, Tiers, force_tier
from arcgym.viewers.segment_bar import draw_segment_bar
from arcgym.viewers.sparkline import draw_sparkline
from arcgym.viewers.tier_bar import draw_tier_bar

_LABEL_SIZE = 12
_VALUE_SIZE = 18
_CELL_GAP = 14
_DOT_WIDTH = 14
_NOTE_GAP = 6
_REWARD_COLOR: Color = (124, 196, 255)


@dataclass(frozen=True)
class Cell:
    """One number with its label."""

    label: str
    """Small text above."""
    value: str
    """The number with its unit."""
    widest: str
    """Text of the largest width that the value can have, so that cells do not move from frame to frame."""
    dot: Color | None = None
    """Color of a dot before the value."""
    note: str = ""
    """Small text after the value, in the dot's color."""
    force: float | None = None
    """Force [N] to mark on a bar of the tiers below the value."""


def octagon(picture: np.ndarray, corner: float = 0.137, ground: Color = DARK) -> Image.Image:
    """Cut the corners off an endoscope picture, as video processors do.

    Args:
        picture: uint8, shape (H, W, 3).
        corner: Side of the triangles cut off, as a fraction of the width.
        ground: Color behind them.

    Returns:
        Picture of the same size.
    """
    height, width = picture.shape[:2]
    cut, scale = corner * width, 4
    mask = Image.new("L", (width * scale, height * scale), 0)
    corners = [(cut, 0), (width - cut, 0), (width, cut), (width, height - cut)]
    corners += [(width - x, height - y) for x, y in corners]
    ImageDraw.Draw(mask).polygon([(x * scale, y * scale) for x, y in corners], fill=255)
    out = Image.new("RGB", (width, height), ground)
    out.paste(Image.fromarray(picture), (0, 0), mask.resize((width, height), Image.Resampling.BOX))
    return out


def draw_panel(
    draw: ImageDraw.ImageDraw,
    box: Box,
    info: FrameInfo,
    bounds: dict[str, tuple[float, float]],
    rewards: Sequence[float],
    forces: Sequence[float],
    tiers: Tiers = FORCE_TIERS,
) -> None:
    """Draw segment bar, numbers and charts into a box.

    Args:
        draw: Where to draw.
        box: Everything drawn stays inside.
        info: What this frame shows.
        bounds: Start and end of each segment [m of arc length].
        rewards: Reward of each frame so far.
        forces: Largest force on a window of the scope of each frame so far [N].
        tiers: Tiers of the force and their colors.
    """
    left, top, right, bottom = box
    draw_segment_bar(draw, (left, top, right, top + 30), bounds, info.tip_arc, info.task_range)
    chart_width = 0.115 * (right - left)
    chart_top = top + 40
    draw_cells(draw, (left, chart_top, right - 2 * chart_width - 24, bottom), cells(info, tiers), tiers)
    first = (right - 2 * chart_width - 8, chart_top, right - chart_width - 8, bottom)
    draw_sparkline(draw, first, rewards, "reward", _REWARD_COLOR, (0.0, 0.1))
    limits = [(tier.start, tier.color) for tier in tiers[1:]]
    second = (right - chart_width, chart_top, right, bottom)
    draw_sparkline(draw, second, forces, "shaft force [N]", INK, (0.0, tiers[1].start + 0.5), limits)


def cells(info: FrameInfo, tiers: Tiers = FORCE_TIERS) -> list[Cell]:
    """Return what is shown as numbers, the most important first."""
    tip, top = force_tier(info.tip_force, tiers), force_tier(info.max_force, tiers)
    shown = [
        Cell("time", f"{info.time:.1f} s", "000.0 s"),
        Cell(f"tip in {info.segment}", f"{100 * info.tip_arc:.1f} cm", "000.0 cm"),
        Cell("inserted", f"{100 * info.inserted:.1f} cm", "000.0 cm"),
        Cell("tip force", f"{info.tip_force:.1f} N", "000.0 N", tip.color, tip.label, info.tip_force),
        Cell("shaft force", f"{info.max_force:.1f} N", "000.0 N", top.color, force=info.max_force),
        Cell("from the tip", "-" if info.max_force_arc is None else f"{100 * info.max_force_arc:.0f} cm", "000 cm"),
    ]
    if info.looping is not None:
        shown.append(Cell("loop ratio", f"{info.looping:.2f}", "0.00"))
    if info.reward is not None:
        shown.append(Cell("reward", f"{info.reward:+.2f}", "+0.00"))
    return shown + [Cell(name, f"{value:+.2f}", "+0.00") for name, value in info.terms.items()]


def draw_cells(draw: ImageDraw.ImageDraw, box: Box, shown: Sequence[Cell], tiers: Tiers = FORCE_TIERS) -> int:
    """Draw cells from left to right as far as they fit, and return how many did."""
    left, top, right, _ = box
    left += 1  # glyphs may reach one pixel to the left of where they start
    for count, cell in enumerate(shown):
        width = _cell_width(draw, cell, tiers)
        if left + width > right:
            return count
        _draw_cell(draw, left, top, width, cell, tiers)
        left += width + _CELL_GAP
    return len(shown)


def _cell_width(draw: ImageDraw.ImageDraw, cell: Cell, tiers: Tiers) -> float:
    """Return the width of a cell, the same whatever tier it is in [px]."""
    value = (_DOT_WIDTH if cell.dot else 0) + max(text_width(draw, t, _VALUE_SIZE) for t in (cell.widest, cell.value))
    if cell.note:
        value += _NOTE_GAP + max(text_width(draw, tier.label, _LABEL_SIZE) for tier in tiers)
    return max(text_width(draw, cell.label, _LABEL_SIZE), value)


def _draw_cell(draw: ImageDraw.ImageDraw, left: float, top: float, width: float, cell: Cell, tiers: Tiers) -> None:
    indent = _DOT_WIDTH if cell.dot else 0
    draw.text((left, top + 4), cell.label, fill=DIM_INK, font=font(_LABEL_SIZE))
    if cell.dot:
        draw.ellipse((left, top + 26, left + 9, top + 35), fill=cell.dot)
    draw.text((left + indent, top + 20), cell.value, fill=INK, font=font(_VALUE_SIZE))
    if cell.note:
        end = left + indent + text_width(draw, cell.value, _VALUE_SIZE) + _NOTE_GAP
        draw.text((end, top + 25), cell.note, fill=cell.dot, font=font(_LABEL_SIZE))
    if cell.force is not None:
        draw_tier_bar(draw, (left, top + 40, left + width, top + 47), cell.force, tiers)
