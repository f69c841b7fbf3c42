# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of architecture.md: ``python docs/_ext/house.py`` writes ``docs/images/house.svg``."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

Stop = tuple[int, str, int]
"""Floor, words and indent [px] of a stop."""

FLOORS: tuple[tuple[tuple[str, str], ...], ...] = (
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
"""Rooms and a few words on each, the roof first; imports point down."""

PICTURE = (
    (6, "wall vertices after the step", 0),
    (5, "skinning, ray tree, uint8 image", 0),
    (3, "term rgb, stack of 5 frames", 0),
    (2, 'obs["policy"], (N, 15, 84, 84)', 0),
    (1, "CNN reads bytes from the rollout", 0),
)
"""Stops of a picture's walk: floor, words, indent [px]."""

ACTION = (
    (1, "policy", 0),
    (2, "env.step(action)", 0),
    (3, "action term clips and scales", 0),
    (7, "actuator.set_command", 0),
    (6, "drive, joints, contact, wall", 34),
)
"""Stops of an action's walk. The actuator lies below the solver, which runs its kernel in each substep."""

WIDTH, HOUSE, LANE, ROW, BOX, GAP, TOP = 1000, 476, 242, 58, 34, 12, 84
LEFT = (WIDTH - HOUSE) // 2
BLUE, ORANGE = ("#1d5fa8", "#e3eefb"), ("#a84a12", "#fdeadd")
WALL, INK, DIM = ("#7d8794", "#f4f6f8"), "#1b2430", "#4c5866"


def picture() -> str:
    """Return the SVG. Every text lies on a light box of its own, readable on light and on dark pages."""
    height = TOP + len(FLOORS) * (ROW + GAP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        'font-family="system-ui, sans-serif" font-size="13">',
        "<title>The rooms of ARCGym as floors of a house, and two walks through them</title>",
        _roof(),
        *(_room(*room, x, y, w) for room, x, y, w in _rooms()),
        *_walk(PICTURE, 8, BLUE, "a picture, from the wall to the CNN"),
        *_walk(ACTION, WIDTH - LANE - 8, ORANGE, "an action, from the policy to a joint"),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _top(floor: int) -> int:
    return TOP + floor * (ROW + GAP)


def _rooms() -> list[tuple[tuple[str, str], float, int, float]]:
    """Return name and words, left edge, top edge and width of every room."""
    placed = []
    for floor, rooms in enumerate(FLOORS):
        width = (HOUSE - GAP * (len(rooms) - 1)) / len(rooms)
        placed += [(room, LEFT + i * (width + GAP), _top(floor), width) for i, room in enumerate(rooms)]
    return placed


def _roof() -> str:
    points = f"{LEFT - 10},{TOP - 8} {WIDTH // 2},{TOP - 70} {LEFT + HOUSE + 10},{TOP - 8}"
    text = _text(WIDTH / 2, TOP - 22, "imports point down", DIM, anchor="middle")
    return f'<polygon points="{points}" fill="{WALL[1]}" stroke="{WALL[0]}"/>{text}'


def _room(name: str, words: str, x: float, y: int, width: float) -> str:
    box = _box(x, y, width, ROW, *WALL)
    title = _text(x + width / 2, y + 25, name, INK, anchor="middle", extra='font-weight="600" font-size="15"')
    return box + title + _text(x + width / 2, y + 44, words, DIM, anchor="middle", extra='font-size="12"')


def _walk(stops: Sequence[Stop], x: int, colors: tuple[str, str], title: str) -> list[str]:
    """Return heading, stops and arrows of a walk in the lane whose left edge is ``x``."""
    stroke, fill = colors
    parts = [_box(x, TOP - 52, LANE, BOX, stroke, stroke), _text(x + LANE / 2, TOP - 30, title, "#ffffff", "middle")]
    for floor, words, indent in stops:
        y = _top(floor) + (ROW - BOX) / 2
        parts.append(_box(x + indent, y, LANE - indent, BOX, stroke, fill))
        parts.append(_text(x + (LANE + indent) / 2, y + 22, words, INK, "middle"))
    floors = [floor for floor, _, _ in stops]
    for start, end in zip(floors, floors[1:], strict=False):
        passed = any(start < floor < end for floor in floors)
        parts.append(_arrow(x + (17 if passed else LANE / 2), start, end, stroke))
    return parts


def _arrow(x: float, start: int, end: int, color: str) -> str:
    """Return an arrow from the stop of a floor to that of another."""
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
    (Path(__file__).parents[1] / "images" / "house.svg").write_text(picture())
