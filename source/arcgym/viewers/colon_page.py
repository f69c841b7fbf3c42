# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A colon on one page: from outside, its wall unrolled, and six views from inside with ARCGym's camera."""

from __future__ import annotations

import math

import numpy as np
from PIL import Image, ImageDraw

from arcgym.anatomy import ColonStage
from arcgym.sensors import SkinnedSurface
from arcgym.viewers.inside_views import SIZE, inside_views
from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg
from arcgym.viewers.unrolled_wall import unrolled_wall

STRIP = 150
"""Height of the unrolled wall [px]."""
GROUND = (16, 19, 25)
INK = (236, 240, 246)
"""Colors of the page and of its text, RGB."""


def draw_page(stage: ColonStage) -> Image.Image:
    """Draw the whole page."""
    width = 6 * SIZE
    outside = [Image.fromarray(picture) for picture in outside_views(stage, width // 2, 2 * SIZE)]
    page = Image.new("RGB", (width, 2 * SIZE + STRIP + SIZE), GROUND)
    pen = ImageDraw.Draw(page)
    for k, picture in enumerate(outside):
        page.paste(picture, (k * width // 2, 0))
    page.paste(Image.fromarray(unrolled_wall(stage, width, STRIP - 24)), (0, 2 * SIZE + 20))
    for name, (start, _) in stage.segment_bounds().items():
        pen.text((start / stage.length * width + 2, 2 * SIZE + 4), name, fill=INK)
    for k, (name, view) in enumerate(inside_views(stage)):
        page.paste(Image.fromarray(view), (k * SIZE, 2 * SIZE + STRIP))
        pen.text((k * SIZE + 6, 2 * SIZE + STRIP + 4), name, fill=INK)
    pen.text((8, 6), f"{stage.name}: {stage.metadata.get('patient', '')}, {stage.length:.2f} m", fill=GROUND)
    pen.text((8, 22), "from the front", fill=GROUND)
    pen.text((width // 2 + 8, 22), "from the patient's left", fill=GROUND)
    return page


def outside_views(stage: ColonStage, width: int, height: int) -> list[np.ndarray]:
    """Draw the translucent colon from the front and from the patient's left."""
    surface = SkinnedSurface(stage.visual_proxy, stage.wall, 1, "cpu")
    pictures = []
    for azimuth in (0.0, 0.5 * math.pi):
        cfg = OutsideViewCfg(width=width, height=height, azimuth=azimuth, outside_length=0.0)
        speck = np.full(2, 1e-4)
        view = OutsideView(cfg, surface, stage.visual_proxy.points, speck, speck, speck)
        hidden = np.tile(stage.centerline.points[0], (2, 1))
        pictures.append(view.render(hidden, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)), np.zeros(2)))
    return pictures
