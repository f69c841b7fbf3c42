# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The cecal end of the path: at the end of the wide lumen, not in small bowel behind the ileocecal valve.

The place within the cecum is found by :mod:`poles` and :mod:`cecum_fit`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.importing.attached_lumen import SETTINGS as ATTACHED
from arcgym.anatomy.importing.attached_lumen import AttachedLumen, is_long, last_shared, thin_tail
from arcgym.anatomy.importing.tree import LumenTree, caliber
from arcgym.anatomy.polyline import arc_lengths


@dataclass(frozen=True)
class CecalEndSettings:
    """Bounds between small bowel and the colon's own end.

    Our choices, set on generated colons with small bowel added (docs/importing.md, "How well").
    """

    tail_share: float = 0.66
    """Largest lumen radius of a tail of small bowel as a share of the colon's before it."""
    tail_radius: float = 0.016
    """Largest lumen radius of such a tail [m]."""
    pole_reach: float = 0.090
    """How far before the tail another branch may leave to the cecal pole [m]."""
    pole_share: float = 0.6
    """Least clearance in that branch as a share of the colon's lumen radius before it."""


SETTINGS = CecalEndSettings()


def without_small_bowel(tree: LumenTree, nodes: np.ndarray) -> tuple[np.ndarray, list[AttachedLumen]]:
    """Cut a thin tail off the cecum's end, and go to the end of the wide lumen instead.

    Args:
        tree: The lumen.
        nodes: Path from the anus, shape (n,).

    Returns:
        The path, and the tail if there was one; what is shorter than its lumen's radius is none.
    """
    points, clearance = tree.points[nodes], tree.clearance[nodes]
    arc, radius = arc_lengths(points), caliber(clearance, points)
    start = thin_tail(arc, radius, SETTINGS.tail_share, SETTINGS.tail_radius)
    if start is None or arc[start] < (1.0 - ATTACHED.largest_cut) * arc[-1] or arc[-1] - arc[start] < radius[start]:
        return nodes, []
    kept = nodes[: start + 1]
    stub = _other_end(tree, kept, nodes[start:], radius)
    if not is_long(arc[-1] - arc[start], float(np.median(radius[start:]))):
        return (nodes if stub is None else stub), []
    neck = float(clearance[start : start + 12].min())
    leak = AttachedLumen("small bowel", points[start:], clearance[start:], neck)
    return (kept if stub is None else stub), [leak]


def _other_end(tree: LumenTree, kept: np.ndarray, cut: np.ndarray, radius: np.ndarray) -> np.ndarray | None:
    """Return the path to the tip that leaves the kept path near its end and is as wide to its end, if there is one."""
    removed, farthest = set(cut[1:].tolist()), 0.0
    arc = arc_lengths(tree.points[kept])
    wide = float(radius[: len(kept)][arc > arc[-1] - ATTACHED.look_back].max())
    best = None
    for tip in tree.tips:
        nodes = tree.between(int(kept[0]), tip)
        if removed & set(nodes.tolist()):
            continue
        leaves = last_shared(nodes, kept)
        beyond = nodes[leaves + 1 :]
        if arc[leaves] < arc[-1] - SETTINGS.pole_reach or not len(beyond):
            continue
        length = arc[leaves] + float(tree.step[beyond].sum())
        if tree.clearance[beyond].max() < SETTINGS.pole_share * wide or length <= farthest:
            continue
        if not _ends_in_small_bowel(tree, nodes):
            best, farthest = nodes, length
    return best


def _ends_in_small_bowel(tree: LumenTree, nodes: np.ndarray) -> bool:
    points = tree.points[nodes]
    arc, radius = arc_lengths(points), caliber(tree.clearance[nodes], points)
    start = thin_tail(arc, radius, SETTINGS.tail_share, SETTINGS.tail_radius)
    return start is not None and is_long(arc[-1] - arc[start], float(np.median(radius[start:])))
