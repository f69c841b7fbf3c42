# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bridge the gaps between pieces of a collapsed or fluid-filled lumen, end to end: the chain is the colon."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.clearance import coarse_clearance
from arcgym.anatomy.importing.tree import LumenTree, caliber, lumen_tree
from arcgym.anatomy.voxel_grid import Grid


@dataclass(frozen=True)
class BridgingSettings:
    """Bounds of pieces and gaps.

    Our choices, set on generated colons with gaps of 5 to 40 mm and small bowel (docs/importing.md, "How well").
    """

    least_tree_volume: float = 3e-6
    """Volume of a piece above which its ends are those of a tree of paths [m^3]; below, those of its long axis."""
    look_back: float = 0.030
    """Length of a piece's end that shows in which direction its lumen goes on [m]."""
    corner_cost: float = 1.5
    """How much longer a gap counts by how far its tips look past each other."""
    least_facing: float = -0.35
    """Least cosine between the direction of a tip and that to the other tip, except in short gaps."""
    short_gap: float = 0.008
    """Largest gap that tips may bridge in any direction [m]."""
    thin_radius: float = 0.007
    """Mean radius of a piece below which it is thin, as small bowel is [m]."""
    small_volume: float = 1.5e-5
    """Volume of a piece below which it is small [m^3]."""
    sure_cost: float = 0.10
    """Cost of a match above which a match of the sides of two ends may be better [m]."""
    large_share: float = 0.10
    """Share of all volume from which a piece's sides are matched: left out, it would be missed."""
    end_region: float = 0.040
    """Distance from a tip within which a piece's surface is its end [m]: a corner is so far from where it was cut."""
    end_way: float = 0.060
    """Length of path behind a tip that its end's middle is on [m]."""
    side_facing: float = 0.3
    """Least cosine between the direction from an end's middle to its side and that to the other end."""


SETTINGS = BridgingSettings()


@dataclass(frozen=True)
class Tip:
    """An end of a piece."""

    point: np.ndarray
    """In the middle of the lumen [m], shape (3,)."""
    direction: np.ndarray
    """Unit vector in which the lumen would go on, shape (3,)."""
    room: float
    """Distance from the point to the wall ahead [m], about the lumen's radius."""
    radius: float
    """Radius of the lumen behind it, between folds [m]."""
    surface: np.ndarray
    """Surface of the end [m], shape (n, 3)."""
    way: np.ndarray
    """Middle of the lumen from the tip backwards [m], shape (m, 3)."""


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
        radius = np.sqrt(self.volume / (np.pi * max(self.length, 1e-3)))
        return self.volume < SETTINGS.small_volume and radius < SETTINGS.thin_radius


@dataclass(frozen=True)
class Bridge:
    """A straight line from one piece to the next."""

    start: np.ndarray
    """First point, inside the lumen [m], shape (3,)."""
    end: np.ndarray
    """Last point [m], shape (3,)."""
    radius: tuple[float, float]
    """Radius of the lumen at either end [m]."""
    volume: float
    """Volume of the smaller of both pieces [m^3]."""


def make_piece(
    grid: Grid, labels: np.ndarray, box: tuple[slice, ...], label: int, volume: float, single: bool
) -> Piece:
    """Find the ends of a piece; of a single one they are not needed."""
    part = np.pad(labels[box] == label, 1)
    origin = grid.origin + grid.spacing * (np.array([s.start for s in box]) - 1)
    voxels = Grid(part.astype(np.float32), origin, grid.spacing)
    middle = voxels.points(np.argwhere(part)).mean(0)
    if single:
        return Piece(label, volume, middle, 1.0, [])
    if volume < SETTINGS.least_tree_volume:
        return _small_piece(voxels, label, volume, middle)
    tree = lumen_tree(coarse_clearance(voxels))
    reach = max(float(tree.step[tree.to_root(tip)].sum()) for tip in tree.tips)
    surface = voxels.points(np.argwhere(part & ~ndimage.binary_erosion(part)))
    return Piece(label, volume, middle, reach, [_tip(tree, tip, voxels, surface) for tip in tree.tips])


def _small_piece(voxels: Grid, label: int, volume: float, middle: np.ndarray) -> Piece:
    """Return a small piece with the ends of its long axis."""
    points = voxels.points(np.argwhere(voxels.mask))
    axis = np.linalg.svd(points - middle, full_matrices=False)[2][0]
    along = (points - middle) @ axis
    radius = float(np.sqrt(volume / (np.pi * max(float(np.ptp(along)), 1e-3))))
    ends = ((int(along.argmin()), -axis), (int(along.argmax()), axis))
    tips = [Tip(points[k], ahead, 0.0, radius, points, points[k][None]) for k, ahead in ends]
    return Piece(label, volume, middle, float(np.ptp(along)), tips)


def _tip(tree: LumenTree, node: int, voxels: Grid, surface: np.ndarray) -> Tip:
    path = tree.to_root(node) if node else _from_root(tree)
    points = tree.points[path]
    first = min(len(points) - 1, int(np.searchsorted(np.cumsum(tree.step[path]), SETTINGS.look_back)))
    ahead = points[0] - points[first]
    ahead = ahead / max(np.linalg.norm(ahead), 1e-9)
    ray = points[0] + 0.0005 * np.arange(1, 100)[:, None] * ahead
    inside = voxels.sample(ray) > 0.5
    radius = float(np.median(caliber(tree.clearance[path], points)[: first + 1]))
    room = 0.0005 * float(len(inside) if inside.all() else inside.argmin())
    near = surface[np.linalg.norm(surface - points[0], axis=1) < SETTINGS.end_region]
    way = points[np.cumsum(tree.step[path]) < SETTINGS.end_way]
    return Tip(points[0], ahead, room, radius, near, way if len(way) else points[:1])


def _from_root(tree: LumenTree) -> list[int]:
    branches = [tree.to_root(tip) for tip in tree.tips if tip]
    return max(branches, key=lambda path: float(tree.step[path].sum()), default=[0])[::-1]


@dataclass(frozen=True)
class Match:
    """Two ends that may be joined."""

    cost: float
    """How little they fit [m]: the gap, made longer by how far they look past each other."""
    pieces: tuple[Piece, Piece]
    """Whose ends they are."""
    tips: tuple[Tip, Tip]
    """The ends."""
    line: tuple[np.ndarray, np.ndarray]
    """First and last point of the bridge [m], each of shape (3,)."""


def join_pieces(pieces: list[Piece], max_gap: float) -> tuple[list[Piece], list[Bridge]]:
    """Join tips that face each other, the best match first, and return the chain with the greatest volume.

    A tip is joined once and no ring is closed. A chain's last piece is left out where it is small and thin. Where tips
    look past each other, as beside a gap between two bends whose ends are taken for corners, the sides of the ends of
    large pieces are matched as well, and what a match leaves of its pieces' lengths counts.
    """
    matches = sorted(_matches(pieces, max_gap), key=lambda match: match.cost)
    sure = [match for match in matches if match.cost <= SETTINGS.sure_cost]
    others = [replace(m, cost=m.cost + sum(map(_left_out, m.pieces, m.tips))) for m in matches[len(sure) :]]
    others += _side_matches(pieces, max_gap)
    chain = {piece: {piece} for piece in pieces}
    used: set[int] = set()
    joined: list[tuple[Piece, Piece, Bridge]] = []
    for match in [*sure, *sorted(others, key=lambda match: match.cost)]:
        (a, b), (first, last) = match.pieces, match.tips
        if id(first) in used or id(last) in used or chain[a] is chain[b]:
            continue
        used |= {id(first), id(last)}
        joined.append((a, b, Bridge(*match.line, (first.radius, last.radius), min(a.volume, b.volume))))
        merged = chain[a] | chain[b]
        for piece in merged:
            chain[piece] = merged
    best = max(chain.values(), key=lambda group: sum(piece.volume for piece in group))
    links = [link for link in joined if link[0] in best]
    while ends := [p for p in best if p.thin and sum(p in link[:2] for link in links) == 1]:
        best = best - set(ends)
        links = [link for link in links if link[0] in best and link[1] in best]
    return [piece for piece in pieces if piece in best], [bridge for _, _, bridge in links]


def _left_out(piece: Piece, tip: Tip) -> float:
    """Return how much shorter the way from a tip to the one farthest from it is than the farthest two are apart [m]."""
    apart = np.linalg.norm([[a.point - b.point for b in piece.tips] for a in piece.tips], axis=2)
    number = next(k for k, each in enumerate(piece.tips) if each is tip)
    return float(apart.max() - apart[number].max())


def _matches(pieces: list[Piece], max_gap: float) -> list[Match]:
    """Return every pair of tips within reach, with the gap made longer by how far they look past each other."""
    found = []
    for a, b in combinations(pieces, 2):
        for first, last in product(a.tips, b.tips):
            offset = last.point - first.point
            distance = float(np.linalg.norm(offset))
            gap = max(distance - first.room - last.room, 1e-3)
            if gap > max_gap:
                continue
            ahead = offset / max(distance, 1e-9)
            facing = (float(first.direction @ ahead), float(-last.direction @ ahead))
            if min(facing) < SETTINGS.least_facing and gap > SETTINGS.short_gap:
                continue
            found.append(Match(_cost(gap, facing), (a, b), (first, last), (first.point, last.point)))
    return found


def _side_matches(pieces: list[Piece], max_gap: float) -> list[Match]:
    """Return pairs of ends of large pieces that come near each other, wherever their tips are."""
    least = SETTINGS.large_share * sum(piece.volume for piece in pieces)
    found = []
    for a, b in combinations([piece for piece in pieces if piece.volume > least], 2):
        for first, last in product(a.tips, b.tips):
            gaps, nearest = cKDTree(last.surface).query(first.surface)
            k = int(gaps.argmin())
            gap, ahead = float(gaps[k]), last.surface[nearest[k]] - first.surface[k]
            ahead = ahead / max(gap, 1e-9)
            (start, side), (end, other) = _middle(first, first.surface[k]), _middle(last, last.surface[nearest[k]])
            facing = (float(side @ ahead), float(-other @ ahead))
            if gap > max_gap or min(facing) < SETTINGS.side_facing:
                continue
            off = np.linalg.norm(first.surface[k] - first.point) + np.linalg.norm(last.surface[nearest[k]] - last.point)
            found.append(Match(_cost(gap, facing) + float(off), (a, b), (first, last), (start, end)))
    return found


def _cost(gap: float, facing: tuple[float, float]) -> float:
    return gap * (1.0 + SETTINGS.corner_cost * (2.0 - sum(facing)))


def _middle(tip: Tip, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle of an end beside a point of its surface, and the direction from there to it."""
    middle = tip.way[np.linalg.norm(tip.way - side, axis=1).argmin()]
    return middle, (side - middle) / max(float(np.linalg.norm(side - middle)), 1e-9)
