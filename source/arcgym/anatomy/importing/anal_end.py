# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The anal end of the path: into the canal, not into a corner of the rectum, and not along a rectal tube."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.attached_lumen import SETTINGS as ATTACHED
from arcgym.anatomy.importing.attached_lumen import AttachedLumen, last_shared, thin_tail
from arcgym.anatomy.importing.tree import LumenTree, caliber
from arcgym.anatomy.polyline import arc_lengths


@dataclass(frozen=True)
class AnalEndSettings:
    """Bounds between anal canal, rectal tube and a rectum that the scan cuts open.

    Our choices, set on generated colons with tubes and collapsed canals (docs/importing.md, "How well").
    """

    tube_share: float = 0.5
    """Largest radius of a tube as a share of the rectum's before it."""
    tube_radius: float = 0.008
    """Largest radius of a tube [m]."""
    tube_length: float = 0.018
    """Least length of a tube [m]."""
    canal_length: float = 0.055
    """Largest length of a collapsed canal [m]."""
    canal_radius: float = 0.0035
    """Largest radius of a collapsed canal, in the middle of its values [m]; a tube is open wider."""
    beside: float = 0.015
    """Length of the rectum right above a canal [m], which is wide there."""
    ampulla_share: float = 0.78
    """Least clearance in the wide part of a rectum as a share of its largest."""
    caliber_reach: float = 0.006
    """Length over which the radius of canals and tubes is taken [m]; the colon's is taken over twice as much."""
    round_share: float = 1.05
    """Largest radius of a tube by the area of its sections over the radius that fits in, ``blur`` apart."""
    blur: float = 0.8
    """Error of that radius, in voxels."""
    branch_reach: float = 0.060
    """Length of the rectum in which a canal may leave [m]."""
    branch_farther: float = 0.005
    """How much farther than the path's end another branch sticks out of the rectum to be the canal [m]."""
    branch_radius: float = 0.004
    """Least radius of that branch, in the middle of its values [m]."""


SETTINGS = AnalEndSettings()


def into_the_canal(tree: LumenTree, nodes: np.ndarray) -> np.ndarray:
    """Lead the path's anal end into the branch there that sticks out most: the canal, not a corner of the rectum.

    Args:
        tree: The lumen.
        nodes: Path from the anus to the cecum, shape (n,).

    Returns:
        The path, with another beginning where a branch of the last 6 cm sticks out of the rectum by 5 mm more.
    """
    back = nodes[::-1]
    arc = arc_lengths(tree.points[back])
    rectum = back[arc > arc[-1] - ATTACHED.look_back]
    best, farthest = back, _out_of(tree, rectum, int(back[-1])) + SETTINGS.branch_farther
    for tip in tree.tips:
        path = tree.between(int(back[0]), tip)
        leaves = last_shared(path, back)
        beyond = path[leaves + 1 :]
        if arc[leaves] < arc[-1] - SETTINGS.branch_reach or len(beyond) < 2 or _out_of(tree, rectum, tip) < farthest:
            continue
        radius = caliber(tree.clearance[beyond], tree.points[beyond], SETTINGS.caliber_reach)
        if float(np.median(radius)) > SETTINGS.branch_radius:
            best, farthest = path, _out_of(tree, rectum, tip)
    return best[::-1]


def _out_of(tree: LumenTree, rectum: np.ndarray, tip: int) -> float:
    """Return how far a tip is out of the balls that fit into the wide part of a rectum [m]."""
    clearance = tree.clearance[rectum]
    wide = rectum[clearance > SETTINGS.ampulla_share * clearance.max()]
    return float((np.linalg.norm(tree.points[wide] - tree.points[tip], axis=1) - tree.clearance[wide]).min())


def without_tube(tree: LumenTree, nodes: np.ndarray) -> tuple[np.ndarray, list[AttachedLumen]]:
    """Cut a thin tube off the anal end.

    Args:
        tree: The lumen.
        nodes: Path from the anus to the cecum, shape (n,).

    Returns:
        The path, and the tube if there was one.
    """
    back = nodes[::-1]
    points, clearance = tree.points[back], tree.clearance[back]
    arc, radius = arc_lengths(points), caliber(clearance, points, SETTINGS.caliber_reach)
    start = thin_tail(arc, radius, SETTINGS.tube_share, SETTINGS.tube_radius)
    if start is None or arc[-1] - arc[start] < SETTINGS.tube_length:
        return nodes, []
    if arc[start] < (1.0 - ATTACHED.largest_cut) * arc[-1]:
        return nodes, []
    if _is_canal(arc, radius, start) or _is_trough(tree, points, radius, start):
        return nodes, []
    tube = AttachedLumen("rectal tube", points[start:], clearance[start:], float(clearance[start : start + 8].min()))
    return back[: start + 1][::-1], [tube]


def _is_canal(arc: np.ndarray, radius: np.ndarray, start: int) -> bool:
    """Return whether a thin tail is a collapsed anal canal: short, nearly closed, and right below the wide rectum.

    A rectal tube is open, longer, or leaves a canal that is narrower than the rectum.
    """
    before = (arc > arc[start] - ATTACHED.look_back) & (arc <= arc[start])
    beside = before & (arc > arc[start] - SETTINGS.beside)
    wide = float(radius[beside].max()) > SETTINGS.ampulla_share * float(radius[before].max())
    short = arc[-1] - arc[start] < SETTINGS.canal_length
    return wide and short and float(np.median(radius[start:])) < SETTINGS.canal_radius


def _is_trough(tree: LumenTree, points: np.ndarray, radius: np.ndarray, start: int) -> bool:
    """Return whether a thin tail is the colon itself, cut open lengthwise: its sections are no discs.

    A scan or a surface that ends in a plane cuts a rectum that runs along that plane into a trough. Half a disc has
    the area of a disc of 1.4 times the radius that fits in.
    """
    _, nearest = cKDTree(points).query(tree.lumen)
    volume = tree.voxel**3 * np.bincount(nearest, minlength=len(points))[start:]
    step = np.linalg.norm(np.diff(points[start:], axis=0), axis=1).mean()
    area = float(np.median(uniform_filter1d(volume, 5))) / step
    largest = SETTINGS.round_share * float(np.median(radius[start:])) + SETTINGS.blur * tree.voxel
    return bool(np.sqrt(area / np.pi) > largest)
