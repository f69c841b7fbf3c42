# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which way through the lumen is the colon, and what hangs on it: small bowel, a rectal tube, pouches."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.formats import FRAMES
from arcgym.anatomy.importing.orientation import likeness
from arcgym.anatomy.importing.tree import LumenTree, caliber

_LEAST_LEAK = 0.035
_LEAK_SHARE = 0.66
_LEAK_CALIBRE = 0.016
_LEAK_SLENDER = 8.0
_OFF_AXIS = 0.5
_MOST_CUT = 0.40
_TUBE_CALIBRE = 0.008
_TUBE_SHARE = 0.5
_LEAST_TUBE = 0.018
_LONGEST_CANAL = 0.055
_BESIDE = 0.015
_AMPULLA_SHARE = 0.78
_OPEN_TUBE = 0.0035
_ROUND, _BLUR = 1.05, 0.8
_BEFORE = 0.080
_POLE_REACH = 0.090
_CANAL_REACH, _CANAL_FARTHER, _CANAL_CALIBRE = 0.060, 0.005, 0.004


@dataclass(frozen=True)
class Attached:
    """A piece of lumen that hangs on the colon and is no part of it."""

    kind: str
    """``small bowel``, ``rectal tube`` or ``side branch``."""
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


@dataclass(frozen=True)
class Course:
    """The nodes of a tree that are the colon's, and what hangs on them."""

    nodes: np.ndarray
    """Nodes from one end to the other, from the anus to the caecum where ``directed``, shape (n,)."""
    attached: list[Attached] = field(default_factory=list)
    """Pieces to cut off."""


def find_course(tree: LumenTree, frame: str, fixed: tuple[int | None, int | None], prune: bool = True) -> Course:
    """Finds the colon in a tree.

    Args:
        tree: The lumen.
        frame: How the tree's axes lie in the patient: a key of ``FRAMES``, or ``auto``.
        fixed: Nodes of the anus and of the caecal pole where they are known.
        prune: Whether to look for what hangs on the colon.
    """
    nodes = _best_path(tree, frame, fixed)
    if not prune:
        return Course(nodes)
    attached: list[Attached] = []
    if fixed[1] is None:
        nodes, cut = _without_leak(tree, nodes)
        attached += cut
    if fixed[0] is None:
        nodes, cut = _without_tube(tree, into_the_canal(tree, nodes))
        attached += cut
    return Course(nodes, attached + _side_branches(tree, nodes, attached))


def _best_path(tree: LumenTree, frame: str, fixed: tuple[int | None, int | None]) -> np.ndarray:
    """Returns the path that looks most like a colon and runs through most and the widest of the lumen."""
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
            score = like + 1.5 * float(weight[nodes].sum()) / total
            if score > best:
                best, found = score, nodes
    return found


def _arc(points: np.ndarray) -> np.ndarray:
    return np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]


def _without_leak(tree: LumenTree, nodes: np.ndarray) -> tuple[np.ndarray, list[Attached]]:
    """Cuts a thin tail off the caecum's end, and goes to the end of the wide lumen instead."""
    points, clearance = tree.points[nodes], tree.clearance[nodes]
    arc, width = _arc(points), caliber(clearance, points)
    start = _thin_tail(arc, width, _LEAK_SHARE, _LEAK_CALIBRE)
    if start is None or arc[start] < (1.0 - _MOST_CUT) * arc[-1]:
        return nodes, []
    kept = nodes[: start + 1]
    stub = _other_end(tree, kept, nodes[start:], width)
    if arc[-1] - arc[start] < max(_LEAST_LEAK, _LEAK_SLENDER * float(np.median(width[start:]))):
        return (nodes if stub is None else stub), []
    neck = float(clearance[start : start + 12].min())
    leak = Attached("small bowel", points[start:], clearance[start:], neck)
    return (kept if stub is None else stub), [leak]


def _thin_tail(arc: np.ndarray, width: np.ndarray, share: float, most: float) -> int | None:
    """Returns where a path becomes thin for the rest of its way, or None."""
    found = None
    for k in range(len(arc) - 1, 0, -1):
        if width[k] > most:
            break
        before = width[(arc > arc[k] - _BEFORE) & (arc <= arc[k])].max()
        if width[k:].max() < share * before:
            found = k
    return found


def _other_end(tree: LumenTree, kept: np.ndarray, cut: np.ndarray, width: np.ndarray) -> np.ndarray | None:
    """Returns the path to the tip that leaves the kept path near its end and is as wide, if there is one."""
    removed, near = set(cut[1:].tolist()), 0.0
    arc = _arc(tree.points[kept])
    place = {int(node): k for k, node in enumerate(kept)}
    wide = float(width[: len(kept)][arc > arc[-1] - _BEFORE].max())
    best = None
    for tip in tree.tips:
        nodes = tree.between(int(kept[0]), tip)
        if removed & set(nodes.tolist()):
            continue
        leaves = max((place[int(n)] for n in nodes if int(n) in place), default=0)
        beyond = nodes[leaves + 1 :]
        if arc[leaves] < arc[-1] - _POLE_REACH or not len(beyond) or tree.clearance[beyond].max() < 0.6 * wide:
            continue
        length = arc[leaves] + float(tree.step[beyond].sum())
        if length > near:
            best, near = nodes, length
    return best


def into_the_canal(tree: LumenTree, nodes: np.ndarray) -> np.ndarray:
    """Leads the anus's end into the branch there that sticks out most: the canal, not a corner of the rectum.

    Args:
        tree: The lumen.
        nodes: Way from the anus to the caecum, shape (n,).

    Returns:
        The way, with another beginning where a branch of the last 6 cm sticks out of the rectum by 5 mm more.
    """
    back = nodes[::-1]
    arc = _arc(tree.points[back])
    rectum = back[arc > arc[-1] - _BEFORE]
    place = {int(node): k for k, node in enumerate(back)}
    best, farthest = back, _out_of(tree, rectum, int(back[-1])) + _CANAL_FARTHER
    for tip in tree.tips:
        way = tree.between(int(back[0]), tip)
        leaves = max((place[int(n)] for n in way if int(n) in place), default=0)
        beyond = way[leaves + 1 :]
        if arc[leaves] < arc[-1] - _CANAL_REACH or len(beyond) < 2 or _out_of(tree, rectum, tip) < farthest:
            continue
        if float(np.median(caliber(tree.clearance[beyond], tree.points[beyond], 0.006))) > _CANAL_CALIBRE:
            best, farthest = way, _out_of(tree, rectum, tip)
    return best[::-1]


def _out_of(tree: LumenTree, rectum: np.ndarray, tip: int) -> float:
    """Returns how far a tip is out of the balls that fit into the wide part of a rectum [m]."""
    clearance = tree.clearance[rectum]
    wide = rectum[clearance > _AMPULLA_SHARE * clearance.max()]
    return float((np.linalg.norm(tree.points[wide] - tree.points[tip], axis=1) - tree.clearance[wide]).min())


def _without_tube(tree: LumenTree, nodes: np.ndarray) -> tuple[np.ndarray, list[Attached]]:
    """Cuts a thin tube off the anus's end."""
    back = nodes[::-1]
    points, clearance = tree.points[back], tree.clearance[back]
    arc, width = _arc(points), caliber(clearance, points, 0.006)
    start = _thin_tail(arc, width, _TUBE_SHARE, _TUBE_CALIBRE)
    if start is None or arc[-1] - arc[start] < _LEAST_TUBE or arc[start] < (1.0 - _MOST_CUT) * arc[-1]:
        return nodes, []
    if _is_canal(arc, width, start) or _is_trough(tree, points, width, start):
        return nodes, []
    tube = Attached("rectal tube", points[start:], clearance[start:], float(clearance[start : start + 8].min()))
    return back[: start + 1][::-1], [tube]


def _is_canal(arc: np.ndarray, width: np.ndarray, start: int) -> bool:
    """Tells whether a thin tail is a collapsed anal canal: short, nearly closed, and right below the wide rectum.

    A rectal tube is open, longer, or leaves a canal that is narrower than the rectum.
    """
    before = (arc > arc[start] - _BEFORE) & (arc <= arc[start])
    beside = before & (arc > arc[start] - _BESIDE)
    wide = float(width[beside].max()) > _AMPULLA_SHARE * float(width[before].max())
    return wide and arc[-1] - arc[start] < _LONGEST_CANAL and float(np.median(width[start:])) < _OPEN_TUBE


def _is_trough(tree: LumenTree, points: np.ndarray, width: np.ndarray, start: int) -> bool:
    """Tells whether a thin tail is the colon itself, cut open lengthwise: its sections are no discs.

    A scan or a surface that ends in a plane cuts a rectum that runs along that plane into a trough. Half a disc has
    the area of a disc of 1.4 times the radius that fits in.
    """
    _, nearest = cKDTree(points).query(tree.lumen)
    volume = tree.voxel**3 * np.bincount(nearest, minlength=len(points))[start:]
    area = (
        float(np.median(uniform_filter1d(volume, 5))) / np.linalg.norm(np.diff(points[start:], axis=0), axis=1).mean()
    )
    return bool(np.sqrt(area / np.pi) > _ROUND * float(np.median(width[start:])) + _BLUR * tree.voxel)


def _side_branches(tree: LumenTree, nodes: np.ndarray, attached: list[Attached]) -> list[Attached]:
    """Returns branches that leave the colon in between and go further than a pouch of it would."""
    colon = tree.points[nodes]
    width = caliber(tree.clearance[nodes], colon)
    on_path, found = set(nodes.tolist()), []
    known = cKDTree(np.concatenate([piece.points for piece in attached])) if attached else None
    taken: set[int] = set()
    for tip in tree.tips:
        way = []
        for node in tree.up(tip):
            if node in on_path:
                break
            way.append(node)
        way = [node for node in way if node not in taken][::-1]
        if len(way) < 2 or (known is not None and np.median(known.query(tree.points[way])[0]) < 1e-4):
            continue
        distance, nearest = cKDTree(colon).query(tree.points[way])
        out = distance > width[nearest] + 0.002
        start = int(out.argmax())
        rest = np.array(way[start:])
        thick = float(np.median(caliber(tree.clearance[rest], tree.points[rest])))
        if not out.any() or tree.step[rest].sum() < max(_LEAST_LEAK, _LEAK_SLENDER * thick):
            continue
        taken |= set(way)
        neck = float(tree.clearance[way[: start + 6]].min())
        found.append(Attached("side branch", tree.points[rest], tree.clearance[rest], neck))
    return found
