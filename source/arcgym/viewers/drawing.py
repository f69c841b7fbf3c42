# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Text and boxes on Pillow images."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from PIL import ImageDraw, ImageFont

Box = tuple[float, float, float, float]
"""Left, top, right and bottom [px]."""
Color = tuple[int, int, int]
"""sRGB, 0..255."""

DARK: Color = (16, 19, 25)
"""Ground of the overlay."""
PANEL: Color = (27, 32, 41)
"""Ground of a box on it."""
INK: Color = (236, 240, 246)
"""Values."""
DIM_INK: Color = (140, 151, 168)
"""Labels."""


@lru_cache(maxsize=16)
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return Pillow's own scalable font at a size [px]."""
    return ImageFont.load_default(size=size)


def text_width(draw: ImageDraw.ImageDraw, text: str, size: int) -> float:
    """Return the width of one line of text [px]."""
    return draw.textlength(text, font=font(size))


def first_fitting(draw: ImageDraw.ImageDraw, texts: Sequence[str], width: float, size: int) -> str:
    """Return the first of `texts` that is no wider than `width` [px], or the empty string."""
    return next((text for text in texts if text_width(draw, text, size) <= width), "")


def mix(color: Color, other: Color, share: float) -> Color:
    """Return `color` with `share` (0..1) of `other` mixed in."""
    red, green, blue = (round(a * (1.0 - share) + b * share) for a, b in zip(color, other, strict=True))
    return red, green, blue
