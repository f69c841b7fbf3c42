# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bar of the force tiers with a mark at the present force."""

from __future__ import annotations

import math

from PIL import ImageDraw

from arcgym.viewers.drawing import DARK, INK, Box, mix
from arcgym.viewers.palette import Tiers

_BEYOND = 1.5
"""End of the bar over the start of the last tier."""


def draw_tier_bar(draw: ImageDraw.ImageDraw, box: Box, force: float, tiers: Tiers) -> None:
    """Draw the tiers side by side, bright up to the force; everything drawn stays inside the box.

    Places go with the square root of the force, so that the low tiers are wide enough to read.

    Args:
        draw: Where to draw.
        box: Left, top, right and bottom [px].
        force: Force to mark [N].
        tiers: Tiers and their colors.
    """
    left, top, right, bottom = box
    end = _BEYOND * tiers[-1].start

    def place(value: float) -> float:
        return left + (right - left) * math.sqrt(min(max(value / end, 0.0), 1.0))

    mark = place(force)
    starts = [tier.start for tier in tiers] + [end]
    for tier, start, stop in zip(tiers, starts, starts[1:], strict=False):
        first, last = place(start), place(stop) - 1
        draw.rectangle((first, top + 2, last, bottom - 2), fill=mix(tier.color, DARK, 0.65))
        if mark > first + 1:
            draw.rectangle((first, top + 2, min(mark, last), bottom - 2), fill=tier.color)
    draw.line([(min(mark, right - 1), top), (min(mark, right - 1), bottom)], fill=INK, width=2)
