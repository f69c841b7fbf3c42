# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Legends of the outside view: colors of scope and wall, scale and sides."""

from __future__ import annotations

import numpy as np
from PIL import ImageDraw

from arcgym.viewers.drawing import Color, font
from arcgym.viewers.palette import Tiers, to_display
from arcgym.viewers.view_camera import ViewCamera
from arcgym.viewers.wall_paint import WallScale

_TEXT: Color = (62, 70, 84)
_FAINT: Color = (128, 138, 154)
_SIZE = 12
_LINE = 16
_BAR = (9, 84)


def draw_legends(
    draw: ImageDraw.ImageDraw, origin: tuple[int, int], camera: ViewCamera, wall: WallScale, tiers: Tiers | None
) -> None:
    """Draw all legends into the picture's corners, where the colon is not.

    Args:
        draw: Where to draw.
        origin: Upper left corner of the outside view in the picture [px].
        camera: Camera of the outside view.
        wall: Colors of the wall.
        tiers: Tiers that the scope is colored by; None where it is plain.
    """
    left, top = origin
    width, height = camera.size
    if tiers is not None:
        _draw_tiers(draw, left + 12, top + height - 14 - _LINE * (len(tiers) + 1), tiers)
    _draw_wall(draw, left + width - 12, top + height - 30 - _BAR[1], wall)
    _draw_scale_bar(draw, left + width - 12, top + 20, camera)
    _draw_sides(draw, origin, camera)


def _draw_tiers(draw: ImageDraw.ImageDraw, x: float, y: float, tiers: Tiers) -> None:
    draw.text((x, y), "wall force per 5 cm", fill=_TEXT, font=font(_SIZE))
    ends = [tier.start for tier in tiers[1:]] + [None]
    for row, (tier, end) in enumerate(zip(tiers, ends, strict=True), start=1):
        span = f"> {tier.start:g}" if end is None else f"{tier.start:g}-{end:g}"
        draw.rounded_rectangle((x, y + row * _LINE + 2, x + 12, y + row * _LINE + 13), radius=2, fill=tier.color)
        draw.text((x + 18, y + row * _LINE), f"{span} N  {tier.label}", fill=_TEXT, font=font(_SIZE))


def _draw_wall(draw: ImageDraw.ImageDraw, right: float, top: float, wall: WallScale) -> None:
    colors = to_display(wall.paint(wall.full * np.linspace(1.0, 0.0, _BAR[1])))
    for row, color in enumerate(colors.tolist()):
        draw.line([(right - _BAR[0], top + row), (right, top + row)], fill=tuple(color))
    for tick in wall.ticks:
        y = top + (1.0 - tick / wall.full) * (_BAR[1] - 1)
        label = f"{wall.per_unit * tick:.3g} {wall.unit}"
        draw.text((right - _BAR[0] - 5, y), label, fill=_TEXT, font=font(_SIZE), anchor="rm")
    draw.text((right, top + _BAR[1] + 6), wall.title, fill=_TEXT, font=font(_SIZE), anchor="ra")


def _draw_scale_bar(draw: ImageDraw.ImageDraw, right: float, y: float, camera: ViewCamera) -> None:
    length = 0.05 * camera.pixels_per_meter(camera.eye + camera.forward * _focus(camera))
    draw.line([(right - length, y), (right, y)], fill=_TEXT, width=2)
    for x in (right - length, right):
        draw.line([(x, y - 3), (x, y + 3)], fill=_TEXT, width=2)
    draw.text((right - 0.5 * length, y - 6), "5 cm", fill=_TEXT, font=font(_SIZE), anchor="ms")


def _focus(camera: ViewCamera) -> float:
    """Return the distance at which the picture is scaled right: to the vertical line through the anus [m]."""
    return float(-camera.eye @ camera.forward)


def _draw_sides(draw: ImageDraw.ImageDraw, origin: tuple[int, int], camera: ViewCamera) -> None:
    """Write which side of the patient is left and right in the picture, for views from the front or the back."""
    if abs(camera.right[0]) < 0.5:
        return
    sides = ("patient right", "patient left")
    at_left, at_right = sides if camera.right[0] < 0.0 else sides[::-1]
    left, top = origin
    y = top + 12
    draw.text((left + 12, y), at_left, fill=_FAINT, font=font(_SIZE))
    draw.text((left + camera.size[0] - 12, y + 22), at_right, fill=_FAINT, font=font(_SIZE), anchor="ra")
