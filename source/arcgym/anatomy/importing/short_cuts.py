# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Short cuts of the path through windows between loops: where a loop of the colon is left out, the way is blocked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.attached_lumen import AttachedLumen
from arcgym.anatomy.importing.colon_path import ColonPath
from arcgym.anatomy.importing.tree import LumenTree, caliber
from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.voxel_grid import Grid


@dataclass(frozen=True)
class ShortCutSettings:
    """What tells a loop of the colon that was left out from small bowel, and where windows are sought. Our choices."""

    caliber_share: float = 0.70
    """Least radius of such a loop over the colon's."""
    length: float = 0.040
    """Least length of such a loop beyond the colon's wall [m]."""
    reach: float = 0.100
    """How far from where the loop leaves the path the window is looked for [m]."""
    necks: int = 4
    """Number of narrow places that are tried, the narrowest first."""
    apart: float = 0.020
    """Least distance of these places along the path [m]."""
    rounds: int = 5
    """How many windows are closed, one after the other."""
    gain: float = 0.003
    """Least gain of the path's score when a window is closed."""
    whole: float = 0.98
    """Least share of the lumen that stays in one piece when a window is closed."""
    wider: float = 1.35
    """How much wider than the neck the lumen may be where it is blocked."""
    window: float = 0.120
    """Half the largest length of a window [m]."""


SETTINGS = ShortCutSettings()

Search = Callable[[Grid], tuple[LumenTree, ColonPath]]
"""Finds the path in the clearance of a lumen."""


def left_out(tree: LumenTree, path: ColonPath) -> list[AttachedLumen]:
    """Return the pieces that hang on the path and are as wide and long as a loop of the colon, the largest first."""
    colon = float(np.median(caliber(tree.clearance[path.nodes], tree.points[path.nodes])))
    pieces = [
        piece
        for piece in (*path.attached, *path.pouches)
        if piece.length >= SETTINGS.length
        and float(np.median(caliber(piece.clearance, piece.points))) >= SETTINGS.caliber_share * colon
    ]
    return sorted(pieces, key=lambda piece: -float((piece.clearance**2).sum()))


def without_short_cuts(
    clearance: Grid, tree: LumenTree, path: ColonPath, search: Search
) -> tuple[Grid, LumenTree, ColonPath, list[np.ndarray]]:
    """Block windows through which the path leaves out a loop of the colon, as long as that makes a better path.

    Args:
        clearance: Distance to the wall [m].
        tree: The lumen.
        path: The path in it.
        search: Finds the path in another clearance.

    Returns:
        The clearance with windows closed, tree and path in it, and the voxels of each window that was closed [m].
    """
    closed: list[np.ndarray] = []
    for _ in range(SETTINGS.rounds):
        loops = left_out(tree, path)
        better = _best_without(clearance, tree, path, loops[0], search) if loops else None
        if better is None:
            break
        clearance, tree, path, window = better
        closed.append(window)
    return clearance, tree, path, closed


def _best_without(
    clearance: Grid, tree: LumenTree, path: ColonPath, loop: AttachedLumen, search: Search
) -> tuple[Grid, LumenTree, ColonPath, np.ndarray] | None:
    """Return the best path with one narrow place near a loop blocked, or None where none is better."""
    best, score = None, path.score + SETTINGS.gain
    for neck in _necks(tree, path.nodes, loop):
        blocked, window = _blocked(clearance, tree, path.nodes, neck)
        if not len(window) or not _stays_whole(clearance, blocked):
            continue
        other_tree, other = search(blocked)
        if other.score > score:
            best, score = (blocked, other_tree, other, window), other.score
    return best


def _stays_whole(before: Grid, after: Grid) -> bool:
    """Return whether hardly any of the lumen is cut off by a wall: one across the colon itself cuts it in two."""
    labels, _ = ndimage.label(after.values > 0, np.ones((3, 3, 3)))
    left = np.bincount(labels.ravel())[1:].max(initial=0) + (before.values > 0).sum() - (after.values > 0).sum()
    return bool(left > SETTINGS.whole * (before.values > 0).sum())


def _necks(tree: LumenTree, nodes: np.ndarray, loop: AttachedLumen) -> list[int]:
    """Return places on the path near a loop at which the lumen is narrow for its surroundings, the narrowest first."""
    points, clearance = tree.points[nodes], tree.clearance[nodes]
    arc = arc_lengths(points)
    leaves = arc[cKDTree(points).query(loop.points[0])[1]]
    relative = clearance / caliber(clearance, points, 0.03)
    near = np.abs(arc - leaves) < SETTINGS.reach
    order = np.flatnonzero(near)[np.argsort(relative[near])]
    chosen: list[int] = []
    for place in order:
        if all(abs(arc[place] - arc[other]) > SETTINGS.apart for other in chosen):
            chosen.append(int(place))
        if len(chosen) == SETTINGS.necks:
            break
    return chosen


def _blocked(clearance: Grid, tree: LumenTree, nodes: np.ndarray, neck: int) -> tuple[Grid, np.ndarray]:
    """Return the clearance with a wall across the path at a place, and the wall's voxels [m], shape (n, 3)."""
    points = tree.points[nodes]
    here = points[neck]
    ahead = points[min(neck + 3, len(points) - 1)] - points[max(neck - 3, 0)]
    ahead /= max(float(np.linalg.norm(ahead)), 1e-9)
    low = np.maximum(np.floor(clearance.index(here - SETTINGS.window)).astype(int), 0)
    high = np.minimum(np.ceil(clearance.index(here + SETTINGS.window)).astype(int) + 1, clearance.values.shape)
    box = tuple(slice(int(a), int(b)) for a, b in zip(low, high, strict=True))
    part = clearance.values[box]
    places = clearance.points(np.indices(part.shape).reshape(3, -1).T + low)
    slab = np.abs((places - here) @ ahead).reshape(part.shape) < 1.1 * clearance.spacing
    narrow = (part > 0) & slab & (part < SETTINGS.wider * tree.clearance[nodes[neck]])
    labels, _ = ndimage.label(narrow, np.ones((3, 3, 3)))
    own = labels[tuple(np.rint(clearance.index(here)).astype(int) - low)]
    if own == 0:
        return clearance, np.zeros((0, 3))
    wall = labels == own
    values = clearance.values.copy()
    values[box][wall] = 0.0
    return Grid(values, clearance.origin, clearance.spacing), clearance.points(np.argwhere(wall) + low)
