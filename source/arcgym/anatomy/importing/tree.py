# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The lumen as a tree of centered paths: the colon, and whatever hangs on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.clearance import passing_cost, widest_near
from arcgym.anatomy.voxel_grid import Grid

_RIDGE = 0.45
"""Least clearance of a branch's tip as a share of the largest nearby: tips lie in the middle of the lumen."""

_COVER = 1.35
"""Radius round a path that it covers, over the largest clearance nearby."""

_COVER_MORE = 0.008
"""Radius that is covered in addition [m]."""

_LEAST_BRANCH = 0.012
"""Length by which a branch is longer than the lumen is wide [m]."""

_MOST_BRANCHES = 80
"""Number of branches after which the search ends."""


@dataclass(frozen=True)
class LumenTree:
    """Nodes along centered paths; the first node is the root."""

    points: np.ndarray
    """Positions [m], shape (n, 3)."""
    parent: np.ndarray
    """Node before each on the path from the root, the root's own is itself, shape (n,)."""
    clearance: np.ndarray
    """Distance to the wall [m], shape (n,)."""
    widest: np.ndarray
    """Largest clearance within 13 mm, more than a node's own where it is off the middle [m], shape (n,)."""
    tips: list[int]
    """Last node of every branch; the root is one where nothing goes on from it in another direction."""
    lumen: np.ndarray
    """Middles of the lumen's voxels [m], shape (m, 3)."""
    voxel: float
    """Edge of these voxels [m]."""

    @cached_property
    def step(self) -> np.ndarray:
        """Distance to the parent [m], shape (n,)."""
        return np.linalg.norm(self.points - self.points[self.parent], axis=1)

    def to_root(self, node: int) -> list[int]:
        """Return the nodes from ``node`` to the root."""
        path = [node]
        while self.parent[path[-1]] != path[-1]:
            path.append(int(self.parent[path[-1]]))
        return path

    def between(self, first: int, last: int) -> np.ndarray:
        """Return the nodes on the path from one node to another, shape (n,)."""
        a, b = self.to_root(first), self.to_root(last)
        shared = set(a)
        meet = next(k for k, node in enumerate(b) if node in shared)
        return np.array(a[: a.index(b[meet])] + b[: meet + 1][::-1])


def caliber(clearance: np.ndarray, points: np.ndarray, reach: float = 0.012) -> np.ndarray:
    """Return the lumen radius between folds along a path [m]: the largest clearance nearby, smoothed, shape (n,)."""
    step = max(float(np.linalg.norm(np.diff(points, axis=0), axis=1).mean()) if len(points) > 1 else 1.0, 1e-5)
    widest = maximum_filter1d(clearance, 2 * round(reach / step) + 1, mode="nearest")
    return gaussian_filter1d(widest, 0.5 * reach / step, mode="nearest")


def lumen_tree(clearance: Grid, given: Sequence[np.ndarray] = ()) -> LumenTree:
    """Cover a lumen with paths, the longest first, until nothing sticks out (after Sato et al., TEASAR, 2000).

    Args:
        clearance: Distance to the wall [m], of one connected lumen.
        given: Voxels that have to be the first tips, in this order; the tree grows from the first of them, or from
            the widest voxel.
    """
    from skimage.graph import MCP_Geometric

    widest = widest_near(clearance)
    widest_voxel = np.array(np.unravel_index(clearance.values.argmax(), clearance.values.shape))
    start = tuple(int(value) for value in (given[0] if len(given) else widest_voxel))
    search = MCP_Geometric(passing_cost(clearance, widest))
    reach, _ = search.find_costs([start])
    ridge = np.argwhere((clearance.values >= np.maximum(_RIDGE * widest, 1e-6)) & np.isfinite(reach))
    cost = reach[tuple(ridge.T)]
    growth = _Growth(start)
    goals = [tuple(int(value) for value in voxel) for voxel in given[1:] if np.isfinite(reach[tuple(voxel)])]
    while goals or (len(cost) and len(growth.tips) < _MOST_BRANCHES):
        must = bool(goals) or not growth.tips
        new = growth.beyond(search.traceback(goals.pop(0) if goals else tuple(ridge[cost.argmax()])))
        length = clearance.spacing * float(np.linalg.norm(np.diff(new, axis=0), axis=1).sum())
        if must or length > widest[tuple(new[0])] + _LEAST_BRANCH:
            growth.add(new)
        distance, nearest = cKDTree(new).query(ridge)
        left = clearance.spacing * distance > _COVER * widest[tuple(new[nearest].T)] + _COVER_MORE
        ridge, cost = ridge[left], cost[left]
    index = np.array(growth.nodes)
    room, wide = (values[tuple(index.T)].astype(float) for values in (clearance.values, widest))
    lumen = clearance.points(np.argwhere(clearance.values > 0))
    points, parent = clearance.points(index), np.array(growth.parent)
    tree = LumenTree(points, parent, room, wide, growth.tips, lumen, clearance.spacing)
    if not len(given) and _passes_through(tree):
        return tree
    return replace(tree, tips=[0, *tree.tips])


class _Growth:
    """Nodes of a tree while it grows."""

    def __init__(self, start: tuple[int, ...]) -> None:
        self.number = {start: 0}
        self.nodes, self.parent = [start], [0]
        self.tips: list[int] = []

    def beyond(self, path: list[tuple[int, ...]]) -> np.ndarray:
        """Return the part of a path from the last voxel that the tree has, shape (n, 3)."""
        known = max(k for k, voxel in enumerate(path) if tuple(voxel) in self.number)
        return np.array(path[known:])

    def add(self, path: np.ndarray) -> None:
        """Add a branch; its first voxel is in the tree."""
        voxels = [tuple(voxel) for voxel in path.tolist()]
        for before, voxel in pairwise(voxels):
            self.number[voxel] = len(self.nodes)
            self.nodes.append(voxel)
            self.parent.append(self.number[before])
        self.tips.append(self.number[voxels[-1]])


def _passes_through(tree: LumenTree) -> bool:
    """Return whether branches leave the root in at least two directions, so that the root is no tip."""
    if len(tree.tips) < 2:
        return False
    reach = 2.0 * tree.clearance[0] + _LEAST_BRANCH
    found = []
    for tip in tree.tips:
        offset = tree.points[tree.to_root(tip)] - tree.points[0]
        out = offset[np.linalg.norm(offset, axis=1) > reach]
        found += [out[-1] / np.linalg.norm(out[-1])] if len(out) else []
    if len(found) < 2:
        return False
    directions = np.array(found)
    return bool((directions @ directions.T).min() < 0.3)
