# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tree-like submucosal vessels, drawn on a periodic image."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import floor

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter

from arcgym.anatomy.mucosa.vessel_styles import STYLES, VesselStyle

_STEP = 6.0
"""Length of a vessel's piece [px]."""

_SUPERSAMPLE = 2
"""Pixels that are drawn for one of the image, along each axis."""

_THINNEST = 0.7
"""Width below which no branch is drawn [px]."""

_FINE_STEPS = 24
"""Largest number of pieces of a small vessel."""

_FULL_WIDTH = 1024
"""Width of the image for which vessels are counted [px]."""

_OVER_THE_EDGE = 20.0
"""How far a vessel may leave its band [px]."""

_MURRAY = 1.0 / 3.0
"""By Murray's law (PNAS, 1926) the cubes of the branches' widths add up to the cube of their parent's."""


@dataclass
class _Branch:
    x: float
    y: float
    angle: float
    width: float
    steps: int
    rises: bool = False
    """Whether it comes up from the depth and so begins thin."""


def draw_vessels(rng: np.random.Generator, height: int, width: int, fine: bool = False) -> np.ndarray:
    """Draw random vessel trees, those of each stretch of the colon in its band of the image.

    Args:
        rng: Source of randomness.
        height: Rows of the image.
        width: Columns of the image.
        fine: Draws small vessels rather than trunks.

    Returns:
        Density of blood, 0 to 1, periodic in both directions, shape (height, width).
    """
    canvas = Image.new("L", (_SUPERSAMPLE * width, _SUPERSAMPLE * height), 0)
    pen = ImageDraw.Draw(canvas)
    for style in STYLES:
        thickest = style.fine_width if fine else style.trunk_width
        share = (style.band[1] - style.band[0]) * (width / _FULL_WIDTH) ** 2
        count = round(share * (style.fine if fine else style.trunks))
        branches = [_trunk(rng, height, width, style, fine) for _ in range(count)]
        band = np.array(style.band) * height + [-_OVER_THE_EDGE, _OVER_THE_EDGE]
        while branches:
            branch = branches.pop()
            path, children = _grow(rng, branch, style.branching, band)
            _stroke(pen, path, branch, thickest, (width, height))
            branches += children
    image = np.asarray(canvas.resize((width, height), Image.Resampling.BOX), np.float32) / 255
    return gaussian_filter(image, 0.45, mode="wrap")


def _trunk(rng: np.random.Generator, height: int, width: int, style: VesselStyle, fine: bool) -> _Branch:
    x, y = rng.uniform(0, width), height * rng.uniform(*style.band)
    angle = np.pi * rng.integers(2) + rng.normal(0.0, 3.0 if fine else style.spread)
    thickest, steps = (style.fine_width, _FINE_STEPS) if fine else (style.trunk_width, style.trunk_steps)
    return _Branch(x, y, angle, thickest * rng.uniform(0.6, 1.0), int(steps * rng.uniform(0.5, 1.0)), True)


def _grow(
    rng: np.random.Generator, branch: _Branch, branching: float, band: np.ndarray
) -> tuple[np.ndarray, list[_Branch]]:
    """Walk along a smoothly winding vessel and let side branches off; it ends in a fork, or where its band ends."""
    bend = np.cumsum(rng.normal(0, 0.05, branch.steps)) + 0.28 * np.sin(np.arange(branch.steps) / rng.uniform(3, 7))
    angle = branch.angle + bend - bend[0]
    path = np.stack([branch.x + _STEP * np.cumsum(np.cos(angle)), branch.y + _STEP * np.cumsum(np.sin(angle))], 1)
    outside = (path[:, 1] < band[0]) | (path[:, 1] > band[1])
    steps = int(outside.argmax()) if outside.any() else branch.steps
    children: list[_Branch] = []
    for k in range(4, steps - 2):
        if rng.random() < branching:
            children += _side(rng, branch, path[k], angle[k], rng.uniform(0.15, 0.45), k / branch.steps)
    if steps < branch.steps:
        return path[:steps], children
    share = rng.uniform(0.35, 0.65)
    for part, side in ((share, 1.0), (1.0 - share, -1.0)):
        child = _child(branch, path[-1], angle[-1] + side * rng.uniform(0.3, 0.75), part, 0.62)
        children += [child] if child.width > _THINNEST else []
    return path, children


def _side(
    rng: np.random.Generator, branch: _Branch, at: np.ndarray, angle: float, share: float, along: float
) -> list[_Branch]:
    side = rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2)
    child = _child(branch, at, angle + side, share, 0.55 * (1.2 - along))
    return [child] if child.width > _THINNEST else []


def _child(branch: _Branch, at: np.ndarray, angle: float, share: float, length: float) -> _Branch:
    width = branch.width * share**_MURRAY * 0.9
    return _Branch(float(at[0]), float(at[1]), angle, width, max(5, int(branch.steps * length)))


def _stroke(pen: ImageDraw.ImageDraw, path: np.ndarray, branch: _Branch, trunk: float, size: tuple[int, int]) -> None:
    """Draw one vessel, thinning towards its end, on the image and on its periodic copies."""
    if len(path) < 2:
        return
    ink = int(255 * min(1.0, 0.35 + 0.65 * branch.width / trunk))
    low, high = path.min(0).tolist(), path.max(0).tolist()
    shifts = [_copies(low[k] - branch.width, high[k] + branch.width, size[k]) for k in (0, 1)]
    thinning, rising = _profiles(len(path))
    thickness = thinning * branch.width * _SUPERSAMPLE
    if branch.rises:
        thickness *= rising
    widths = np.maximum(1, np.rint(thickness[:-1])).astype(int)
    changes = [0, *(np.flatnonzero(widths[1:] != widths[:-1]) + 1).tolist(), len(widths)]
    pieces = [(2 * first, 2 * last + 2, int(widths[first])) for first, last in pairwise(changes)]
    for dx in shifts[0]:
        for dy in shifts[1]:
            points = ((path + [dx, dy]) * _SUPERSAMPLE).ravel().tolist()
            for first, last, width in pieces:  # of the same width at once
                pen.line(points[first:last], fill=ink, width=width)


def _copies(low: float, high: float, size: int) -> list[int]:
    """Return the shifts [px] by which what lies between two bounds meets the image."""
    return [k * size for k in range(-floor(high / size), -floor(low / size) + 1)]


@cache
def _profiles(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return shares of a vessel's width along its points: thinning towards its end, and rising from the depth."""
    return np.linspace(1.0, 0.8, count), np.minimum(1.0, np.linspace(0.1, 3.0, count))
