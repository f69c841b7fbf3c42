# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon among the paths through a tree of the lumen, and the lumen that hangs on it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from arcgym.anatomy.importing.anal_end import into_the_canal, without_tube
from arcgym.anatomy.importing.attached_lumen import AttachedLumen, side_branches
from arcgym.anatomy.importing.cecal_end import without_small_bowel
from arcgym.anatomy.importing.formats import FRAMES
from arcgym.anatomy.importing.orientation import likeness
from arcgym.anatomy.importing.tree import LumenTree

_VOLUME_WEIGHT = 1.5
"""Weight of the share of the lumen that a path runs through, beside its likeness to a typical course; our choice."""

_OFF_AXIS = 0.5
"""Weight of the lumen that a path leaves aside because it runs off the middle; our choice."""


@dataclass(frozen=True)
class ColonPath:
    """The nodes of a tree that are the colon's, and what hangs on them."""

    nodes: np.ndarray
    """Nodes from one end to the other, from the anus to the cecum where that is known, shape (n,)."""
    attached: list[AttachedLumen] = field(default_factory=list)
    """Pieces to cut off."""
    pouches: list[AttachedLumen] = field(default_factory=list)
    """Pieces that are left: pouches of the colon, or leaks as wide as they."""
    score: float = 0.0
    """Likeness to a typical course, and share of the lumen that the path runs through."""


def find_colon_path(tree: LumenTree, frame: str, fixed: tuple[int | None, int | None], prune: bool = True) -> ColonPath:
    """Find the colon in a tree.

    Args:
        tree: The lumen.
        frame: How the tree's axes lie in the patient: a key of ``FRAMES``, or ``auto``.
        fixed: Nodes of the anus and of the cecal pole where they are known.
        prune: Whether to look for attached lumen.
    """
    nodes, score = _best_path(tree, frame, fixed)
    if not prune:
        return ColonPath(nodes, score=score)
    attached: list[AttachedLumen] = []
    if fixed[1] is None:
        nodes, cut = without_small_bowel(tree, nodes)
        attached += cut
    if fixed[0] is None:
        nodes, cut = without_tube(tree, into_the_canal(tree, nodes))
        attached += cut
    branches = side_branches(tree, nodes, attached)
    attached += [piece for piece in branches if piece.kind != "pouch"]
    return ColonPath(nodes, attached, [piece for piece in branches if piece.kind == "pouch"], score)


def _best_path(tree: LumenTree, frame: str, fixed: tuple[int | None, int | None]) -> tuple[np.ndarray, float]:
    """Return the path that looks most like a colon and runs through most and the widest of the lumen; and its score."""
    frames = list(FRAMES) if frame == "auto" else [frame]
    firsts = tree.tips if fixed[0] is None else [fixed[0]]
    lasts = tree.tips if fixed[1] is None else [fixed[1]]
    weight = tree.step * (tree.clearance**3 - _OFF_AXIS * (tree.widest**3 - tree.clearance**3))
    total = float((tree.step * tree.clearance**3).sum())
    best, found = -np.inf, np.array([0])
    for first in firsts:
        for last in lasts:
            if first == last:
                continue
            nodes = tree.between(first, last)
            like = max(likeness(tree.points[nodes], FRAMES[name], False) for name in frames)
            score = like + _VOLUME_WEIGHT * float(weight[nodes].sum()) / total
            if score > best:
                best, found = score, nodes
    return found, float(best)
