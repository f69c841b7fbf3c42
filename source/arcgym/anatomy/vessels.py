# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tree-like submucosal vessels, drawn on a periodic image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter

_STEP = 6.0
_SUPERSAMPLE = 2
_THINNEST = 0.7
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


def draw_vessels(rng: np.random.Generator, height: int, width: int, count: int, trunk: float, steps: int) -> np.ndarray:
    """Draws random vessel trees.

    Args:
        rng: Source of randomness.
        height: Rows of the image.
        width: Columns of the image.
        count: Number of trees.
        trunk: Width of the widest vessel [px].
        steps: Length of the longest unbranched vessel in steps of 6 px.

    Returns:
        Density of blood, 0 to 1, periodic in both directions, shape (height, width).
    """
    canvas = Image.new("L", (_SUPERSAMPLE * width, _SUPERSAMPLE * height), 0)
    pen = ImageDraw.Draw(canvas)
    branches = [_trunk(rng, height, width, trunk, steps) for _ in range(count)]
    while branches:
        branch = branches.pop()
        path, children = _grow(rng, branch)
        _stroke(pen, path, branch, trunk, (width, height))
        branches += children
    image = np.asarray(canvas.resize((width, height), Image.Resampling.BOX), float) / 255
    return gaussian_filter(image, 0.45, mode="wrap")


def _trunk(rng: np.random.Generator, height: int, width: int, trunk: float, steps: int) -> _Branch:
    x, y, angle = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0, 2 * np.pi)
    return _Branch(x, y, angle, trunk * rng.uniform(0.6, 1.0), int(steps * rng.uniform(0.5, 1.0)), True)


def _grow(rng: np.random.Generator, branch: _Branch) -> tuple[np.ndarray, list[_Branch]]:
    """Walks along a smoothly winding vessel and lets side branches off; it ends in a fork."""
    bend = np.cumsum(rng.normal(0, 0.05, branch.steps)) + 0.28 * np.sin(np.arange(branch.steps) / rng.uniform(3, 7))
    angle = branch.angle + bend - bend[0]
    path = np.stack([branch.x + _STEP * np.cumsum(np.cos(angle)), branch.y + _STEP * np.cumsum(np.sin(angle))], 1)
    children: list[_Branch] = []
    for k in range(4, branch.steps - 2):
        if rng.uniform() < 0.10:
            children += _side(rng, branch, path[k], angle[k], rng.uniform(0.15, 0.45), k / branch.steps)
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
    """Draws one vessel, thinning towards its end, on the image and on its periodic copies."""
    ink = int(255 * min(1.0, 0.35 + 0.65 * branch.width / trunk))
    low, high = path.min(0) - branch.width, path.max(0) + branch.width
    shifts = [np.arange(-np.floor(high[k] / size[k]), -np.floor(low[k] / size[k]) + 1) for k in (0, 1)]
    thickness = np.linspace(1.0, 0.8, len(path)) * branch.width * _SUPERSAMPLE
    if branch.rises:
        thickness *= np.minimum(1.0, np.linspace(0.1, 3.0, len(path)))
    for dx in shifts[0] * size[0]:
        for dy in shifts[1] * size[1]:
            points = (path + [dx, dy]) * _SUPERSAMPLE
            for k in range(len(path) - 1):
                ends = [tuple(points[k]), tuple(points[k + 1])]
                pen.line(ends, fill=ink, width=max(1, round(thickness[k])))
