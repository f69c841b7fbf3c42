# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Lumen that hangs on the colon and is no part of it: small bowel, a rectal tube, leaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.tree import LumenTree, caliber


@dataclass(frozen=True)
class AttachedSettings:
    """Bounds between attached lumen and what the colon itself has: pouches, folds, a tapering cecum.

    Our choices, set on generated colons with small bowel and tubes added (docs/importing.md, "How well").
    """

    least_length: float = 0.035
    """Least length of a leak or side branch [m]; shorter ones are pouches of the colon."""
    slenderness: float = 8.0
    """Least length of a leak or side branch over its lumen radius."""
    look_back: float = 0.080
    """Length of the colon before a thin stretch with which that is compared [m]."""
    largest_cut: float = 0.40
    """Largest share of a path that may be cut off at one of its ends."""
    beyond_wall: float = 0.002
    """How far out of the colon's own lumen a side branch begins [m]."""
    leak_length: float = 0.025
    """Least length of a leak [m]: it leaves the colon through a neck, and is wider behind it."""
    leak_neck: float = 0.6
    """Largest neck of a leak over its widest place."""
    leak_share: float = 0.7
    """Largest radius of a leak over the colon's there; what is wider may be a loop of the colon."""
    least_pouch: float = 0.015
    """Length from which what is left as a pouch of the colon is reported [m]."""


SETTINGS = AttachedSettings()


@dataclass(frozen=True)
class AttachedLumen:
    """A piece of lumen that hangs on the colon."""

    kind: str
    """``small bowel``, ``rectal tube``, ``side branch``, ``leak``, or ``pouch`` for what is not cut off."""
    points: np.ndarray
    """Its middle line from the neck outwards [m], shape (n, 3)."""
    clearance: np.ndarray
    """Distance to its wall [m], shape (n,)."""
    neck: float
    """Least radius where it leaves the colon [m]."""

    @property
    def length(self) -> float:
        """Length from the neck to the tip [m]."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


def is_long(length: float, radius: float) -> bool:
    """Return whether a thin piece of a length and a lumen radius [m] is longer than a pouch of the colon."""
    return length >= max(SETTINGS.least_length, SETTINGS.slenderness * radius)


def thin_tail(arc: np.ndarray, radius: np.ndarray, share: float, largest: float) -> int | None:
    """Return the index from which a path stays thin up to its end, or None.

    Args:
        arc: Arc length of the path's points [m], shape (n,).
        radius: Lumen radius between folds at them [m], shape (n,).
        share: Largest radius of the tail as a share of that before it.
        largest: Largest radius of the tail [m].
    """
    found = None
    for k in range(len(arc) - 1, 0, -1):
        if radius[k] > largest:
            break
        before = radius[(arc > arc[k] - SETTINGS.look_back) & (arc <= arc[k])].max()
        if radius[k:].max() < share * before:
            found = k
    return found


def last_shared(path: np.ndarray, trunk: np.ndarray) -> int:
    """Return the place in ``trunk`` of the last node that a path from its first node shares with it."""
    place = {int(node): k for k, node in enumerate(trunk)}
    return max((place[int(node)] for node in path if int(node) in place), default=0)


def side_branches(tree: LumenTree, nodes: np.ndarray, attached: list[AttachedLumen]) -> list[AttachedLumen]:
    """Return branches that leave the colon in between: long ones, leaks, and pouches, which are the colon's own.

    Args:
        tree: The lumen.
        nodes: Nodes of the colon, shape (n,).
        attached: Pieces that are known already.
    """
    colon = tree.points[nodes]
    radius = caliber(tree.clearance[nodes], colon)
    on_colon, found = set(nodes.tolist()), []
    known = cKDTree(np.concatenate([piece.points for piece in attached])) if attached else None
    taken: set[int] = set()
    for tip in tree.tips:
        branch = [node for node in _up_to(tree, tip, on_colon) if node not in taken][::-1]
        if len(branch) < 2 or (known is not None and np.median(known.query(tree.points[branch])[0]) < 1e-4):
            continue
        distance, nearest = cKDTree(colon).query(tree.points[branch])
        out = distance > radius[nearest] + SETTINGS.beyond_wall
        start = int(out.argmax())
        rest = np.array(branch[start:])
        thick = float(np.median(caliber(tree.clearance[rest], tree.points[rest])))
        if not out.any():
            continue
        neck = float(tree.clearance[branch[: start + 6]].min())
        thin = thick < SETTINGS.leak_share * radius[nearest[start]]
        kind = _kind(
            float(tree.step[rest].sum()), thick, thin and neck < SETTINGS.leak_neck * tree.clearance[rest].max()
        )
        if kind is not None:
            taken |= set(branch)
            found.append(AttachedLumen(kind, tree.points[rest], tree.clearance[rest], neck))
    return found


def _kind(length: float, thick: float, narrow: bool) -> str | None:
    """Return what a branch is by length, lumen radius [m] and whether its neck is narrow; None if it is short."""
    if is_long(length, thick):
        return "side branch"
    if length >= SETTINGS.leak_length and narrow:
        return "leak"
    return "pouch" if length >= SETTINGS.least_pouch else None


def _up_to(tree: LumenTree, tip: int, ends: set[int]) -> list[int]:
    """Return the nodes from a tip towards the root, up to the first of ``ends``, which is left out."""
    path = []
    for node in tree.to_root(tip):
        if node in ends:
            break
        path.append(node)
    return path
