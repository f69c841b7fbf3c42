# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the pieces of a collapsed or fluid-filled lumen, end to end, into the chain that is the colon."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from arcgym.anatomy.importing.clearance import coarse_clearance
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.tree import LumenTree, lumen_tree

_WITH_TREE = 3e-6
_LOOK_BACK = 0.030
_ROUND_CORNERS = 1.5
_LEAST_FACING = -0.35
_CLOSE = 0.008
_THIN = 0.007
_SMALL = 1.5e-5


@dataclass(frozen=True)
class Tip:
    """An end of a piece."""

    point: np.ndarray
    """In the middle of the lumen [m], shape (3,)."""
    way: np.ndarray
    """Unit vector in which the lumen would go on, shape (3,)."""
    room: float
    """Distance from the point to the wall ahead [m], about the lumen's radius."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A connected part of the mask."""

    label: int
    """Its number."""
    volume: float
    """Volume [m^3]."""
    middle: np.ndarray
    """Mean position [m], shape (3,)."""
    length: float
    """Length of its longest path [m]."""
    tips: list[Tip]
    """Its ends."""

    @property
    def thin(self) -> bool:
        """Whether it is small and thin: a small bowel loop or a tube, unless it lies between two wider pieces."""
        return self.volume < _SMALL and np.sqrt(self.volume / (np.pi * max(self.length, 1e-3))) < _THIN


@dataclass(frozen=True)
class Bridge:
    """A straight way from one piece to the next."""

    start: np.ndarray
    """First point, inside the lumen [m], shape (3,)."""
    end: np.ndarray
    """Last point [m], shape (3,)."""
    volume: float
    """Volume of the smaller of both pieces [m^3]."""


def make_piece(
    grid: Grid, labels: np.ndarray, box: tuple[slice, ...], label: int, volume: float, single: bool
) -> Piece:
    """Finds the ends of a piece; of a single one they are not needed."""
    part = np.pad(labels[box] == label, 1)
    origin = grid.origin + grid.spacing * (np.array([s.start for s in box]) - 1)
    voxels = Grid(part.astype(np.float32), origin, grid.spacing)
    middle = voxels.points(np.argwhere(part)).mean(0)
    if single:
        return Piece(label, volume, middle, 1.0, [])
    if volume < _WITH_TREE:
        return _compact(voxels, label, volume, middle)
    tree = lumen_tree(coarse_clearance(voxels))
    reach = max(float(tree.step[tree.up(tip)].sum()) for tip in tree.tips)
    return Piece(label, volume, middle, reach, [_tip(tree, tip, voxels) for tip in tree.tips])


def _compact(voxels: Grid, label: int, volume: float, middle: np.ndarray) -> Piece:
    """Takes the ends of a small piece's long axis."""
    points = voxels.points(np.argwhere(voxels.mask))
    axis = np.linalg.svd(points - middle, full_matrices=False)[2][0]
    along = (points - middle) @ axis
    tips = [Tip(points[along.argmin()], -axis, 0.0), Tip(points[along.argmax()], axis, 0.0)]
    return Piece(label, volume, middle, float(np.ptp(along)), tips)


def _tip(tree: LumenTree, node: int, voxels: Grid) -> Tip:
    way = tree.up(node) if node else _from_root(tree)
    points = tree.points[way]
    back = points[min(len(points) - 1, int(np.searchsorted(np.cumsum(tree.step[way]), _LOOK_BACK)))]
    ahead = points[0] - back
    ahead = ahead / max(np.linalg.norm(ahead), 1e-9)
    ray = points[0] + 0.0005 * np.arange(1, 100)[:, None] * ahead
    inside = voxels.sample(ray) > 0.5
    return Tip(points[0], ahead, 0.0005 * float(len(inside) if inside.all() else inside.argmin()))


def _from_root(tree: LumenTree) -> list[int]:
    longest = max((tip for tip in tree.tips if tip), key=lambda tip: float(tree.step[tree.up(tip)].sum()), default=0)
    return tree.up(longest)[::-1]


def join_pieces(pieces: list[Piece], max_gap: float) -> tuple[list[Piece], list[Bridge]]:
    """Joins tips that face each other, the best match first, and returns the chain with the greatest volume.

    A tip is joined once and no ring is closed. A chain's last piece is left out where it is small and thin.
    """
    matches = sorted(_matches(pieces, max_gap), key=lambda match: match[0])
    chain = {piece: {piece} for piece in pieces}
    used: set[int] = set()
    joined: list[tuple[Piece, Piece, Bridge]] = []
    for _, a, b, first, last in matches:
        if id(first) in used or id(last) in used or chain[a] is chain[b]:
            continue
        used |= {id(first), id(last)}
        joined.append((a, b, Bridge(first.point, last.point, min(a.volume, b.volume))))
        merged = chain[a] | chain[b]
        for piece in merged:
            chain[piece] = merged
    best = max(chain.values(), key=lambda group: sum(piece.volume for piece in group))
    links = [link for link in joined if link[0] in best]
    while ends := [p for p in best if p.thin and sum(p in link[:2] for link in links) == 1]:
        best = best - set(ends)
        links = [link for link in links if link[0] in best and link[1] in best]
    return [piece for piece in pieces if piece in best], [bridge for _, _, bridge in links]


def _matches(pieces: list[Piece], max_gap: float) -> list[tuple[float, Piece, Piece, Tip, Tip]]:
    """Returns every pair of tips within reach, with the gap made longer by how far they look past each other."""
    found = []
    for a, b in combinations(pieces, 2):
        for first in a.tips:
            for last in b.tips:
                offset = last.point - first.point
                distance = float(np.linalg.norm(offset))
                gap = max(distance - first.room - last.room, 1e-3)
                if gap > max_gap:
                    continue
                ahead = offset / max(distance, 1e-9)
                facing = (float(first.way @ ahead), float(-last.way @ ahead))
                if min(facing) < _LEAST_FACING and gap > _CLOSE:
                    continue
                found.append((gap * (1.0 + _ROUND_CORNERS * (2.0 - sum(facing))), a, b, first, last))
    return found
