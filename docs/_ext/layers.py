# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of architecture.md: ``python docs/_ext/layers.py`` writes ``docs/images/layers.svg``."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

Stop = tuple[int, str, int]
"""Layer, words and indent [px] of a stop."""

LAYERS: tuple[tuple[tuple[str, str], ...], ...] = (
    (("cli", "the command"), ("teleop", "the page"), ("studies", "grids"), ("recordings", "replay, data")),
    (("rl", "rsl_rl"), ("evaluation", "trials"), ("arcgym_tasks", "config"), ("benchmarks", "arcgym bench")),
    (("envs", "ManagerBasedRLEnv, its terms in envs.mdp"),),
    (("managers", "observation, action, reward, ..."), ("viewers", "pictures, videos")),
    (("scene", "all worlds"), ("experts", "scripted"), ("start_states", "made once, kept")),
    (("sensors", "camera at the tip: skinning, rays, light"),),
    (("sim", "scope solver, wall solver, contact, coupling"),),
    (("anatomy", "colons: generator, importer"), ("assets", "USD stages, actuators")),
    (("utils", "configclass, validation, overrides, registry"),),
)
"""Packages and a few words on each, the uppermost layer first; imports point down."""

PICTURE = (
    (6, "wall vertices after the step", 0),
    (5, "skinning, ray tree, uint8 image", 0),
    (3, "term rgb, stack of 5 frames", 0),
    (2, 'obs["policy"], (N, 15, 84, 84)', 0),
    (1, "CNN reads bytes from the rollout", 0),
)
"""Stops of a picture on its way: layer, words, indent [px]."""

ACTION = (
    (1, "policy", 0),
    (2, "env.step(action)", 0),
    (3, "action term clips and scales", 0),
    (7, "actuator.set_command", 0),
    (6, "drive, joints, contact, wall", 34),
)
"""Stops of an action on its way. The actuator lies below the solver, which runs its kernel in each substep."""

WIDTH, STACK, LANE, ROW, BOX, GAP, TOP = 1000, 476, 242, 58, 34, 12, 84
LEFT = (WIDTH - STACK) // 2
BLUE, ORANGE = ("#1d5fa8", "#e3eefb"), ("#a84a12", "#fdeadd")
WALL, INK, DIM = ("#7d8794", "#f4f6f8"), "#1b2430", "#4c5866"


def picture() -> str:
    """Return the SVG. Every text lies on a light box of its own, readable on light and on dark pages."""
    height = TOP + len(LAYERS) * (ROW + GAP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        'font-family="system-ui, sans-serif" font-size="13">',
        "<title>The packages of ARCGym in layers, and two ways through them</title>",
        _roof(),
        *(_package(*package, x, y, w) for package, x, y, w in _packages()),
        *_way(PICTURE, 8, BLUE, "a picture, from the wall to the CNN"),
        *_way(ACTION, WIDTH - LANE - 8, ORANGE, "an action, from the policy to a joint"),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _top(layer: int) -> int:
    return TOP + layer * (ROW + GAP)


def _packages() -> list[tuple[tuple[str, str], float, int, float]]:
    """Return name and words, left edge, top edge and width of every package."""
    placed = []
    for layer, packages in enumerate(LAYERS):
        width = (STACK - GAP * (len(packages) - 1)) / len(packages)
        placed += [(package, LEFT + i * (width + GAP), _top(layer), width) for i, package in enumerate(packages)]
    return placed


def _roof() -> str:
    points = f"{LEFT - 10},{TOP - 8} {WIDTH // 2},{TOP - 70} {LEFT + STACK + 10},{TOP - 8}"
    text = _text(WIDTH / 2, TOP - 22, "imports point down", DIM, anchor="middle")
    return f'<polygon points="{points}" fill="{WALL[1]}" stroke="{WALL[0]}"/>{text}'


def _package(name: str, words: str, x: float, y: int, width: float) -> str:
    box = _box(x, y, width, ROW, *WALL)
    title = _text(x + width / 2, y + 25, name, INK, anchor="middle", extra='font-weight="600" font-size="15"')
    return box + title + _text(x + width / 2, y + 44, words, DIM, anchor="middle", extra='font-size="12"')


def _way(stops: Sequence[Stop], x: int, colors: tuple[str, str], title: str) -> list[str]:
    """Return heading, stops and arrows of a way in the lane whose left edge is ``x``."""
    stroke, fill = colors
    parts = [_box(x, TOP - 52, LANE, BOX, stroke, stroke), _text(x + LANE / 2, TOP - 30, title, "#ffffff", "middle")]
    for layer, words, indent in stops:
        y = _top(layer) + (ROW - BOX) / 2
        parts.append(_box(x + indent, y, LANE - indent, BOX, stroke, fill))
        parts.append(_text(x + (LANE + indent) / 2, y + 22, words, INK, "middle"))
    layers = [layer for layer, _, _ in stops]
    for start, end in zip(layers, layers[1:], strict=False):
        passed = any(start < layer < end for layer in layers)
        parts.append(_arrow(x + (17 if passed else LANE / 2), start, end, stroke))
    return parts


def _arrow(x: float, start: int, end: int, color: str) -> str:
    """Return an arrow from the stop of a layer to that of another."""
    down = end > start
    y1 = _top(start) + (ROW + BOX) / 2 if down else _top(start) + (ROW - BOX) / 2
    y2 = _top(end) + (ROW - BOX) / 2 - 8 if down else _top(end) + (ROW + BOX) / 2 + 8
    tip = y2 + (7 if down else -7)
    head = f'<path d="M{x - 5:.1f} {y2:.1f} {x + 5:.1f} {y2:.1f} {x:.1f} {tip:.1f}z" fill="{color}"/>'
    return f'<line x1="{x:.1f}" y1="{y1:.1f}" x2="{x:.1f}" y2="{y2:.1f}" stroke="{color}" stroke-width="2.5"/>{head}'


def _box(x: float, y: float, width: float, height: float, stroke: str, fill: str) -> str:
    return (
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height}" rx="5" fill="{fill}" stroke="{stroke}"/>'
    )


def _text(x: float, y: float, text: str, fill: str, anchor: str = "start", extra: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="{fill}" text-anchor="{anchor}" {extra}>{escape(text)}</text>'


if __name__ == "__main__":
    (Path(__file__).parents[1] / "images" / "layers.svg").write_text(picture())
