# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Level curves of a conformal map as rings of evenly chosen points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from arcgym.anatomy.meshing.conformal_map import ConformalMap

_ROUND = 0.1
"""By how much the turns of a main loop may differ from one."""


@dataclass(frozen=True)
class _Crossings:
    """Points where level curves cross edges of the surface, and the pieces of curve that join them."""

    level: np.ndarray
    """Number of each point's level, shape (n,)."""
    position: np.ndarray
    """Positions [m], shape (n, 3)."""
    angle: np.ndarray
    """v of each point [rad], shape (n,)."""
    start: np.ndarray
    """Point where each piece begins, shape (m,)."""
    end: np.ndarray
    """Point where it ends, shape (m,)."""


def level_rings(
    mapped: ConformalMap, levels: np.ndarray, sectors: int, by_length: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the loop of each level curve that winds once round the lumen, as points.

    Args:
        mapped: Map of the surface.
        levels: Values of u, ascending, shape (R,).
        sectors: Points of a ring.
        by_length: Share of the points' distribution that follows the length of the curve; the rest follows v, which
            leaves few points to pouches.

    Returns:
        Positions [m], shape (R, sectors, 3); v there, ascending by a full turn along a ring [rad], shape (R, sectors);
        and whether each level has such a loop, shape (R,).
    """
    found = _find_crossings(mapped, np.asarray(levels, float))
    following = np.full(len(found.level), -1)
    following[found.start] = found.end
    chain_to = following.tolist()
    rings = np.full((len(levels), sectors, 4), np.nan)
    for first, turns in _main_loops(found, len(levels)):
        loop = _walk(chain_to, first)
        if loop:
            loop = loop[:: 1 if turns > 0 else -1]
            rings[found.level[first]] = _resample(found.position[loop], found.angle[loop], sectors, by_length)
    return rings[..., :3], rings[..., 3], np.isfinite(rings[:, 0, 0])


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Return angles in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _find_crossings(mapped: ConformalMap, levels: np.ndarray) -> _Crossings:
    faces, u = mapped.faces, mapped.u
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    edge, side = np.unique(sides, axis=0, return_inverse=True)
    edge_of = side.reshape(3, -1).T
    low, high = (np.searchsorted(levels, bound, "right") for bound in (u[faces].min(1), u[faces].max(1)))
    count = high - low
    face = np.repeat(np.arange(len(faces)), count)
    level = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
    above = u[faces[face]] >= levels[level][:, None]
    leaving, entering = above & ~np.roll(above, -1, 1), ~above & np.roll(above, -1, 1)
    key = level.astype(np.int64) * len(edge)
    start, end = (key + edge_of[face, mark.argmax(1)] for mark in (entering, leaving))
    node, place = np.unique(np.concatenate([start, end]), return_inverse=True)
    number, ends = node // len(edge), edge[node % len(edge)]
    share = (levels[number] - u[ends[:, 0]]) / (u[ends[:, 1]] - u[ends[:, 0]])
    a, b = mapped.points[ends[:, 0]], mapped.points[ends[:, 1]]
    angle = mapped.v[ends[:, 0]] + share * wrapped(mapped.v[ends[:, 1]] - mapped.v[ends[:, 0]])
    return _Crossings(number, a + share[:, None] * (b - a), angle, *place.reshape(2, -1))


def _main_loops(found: _Crossings, count: int) -> list[tuple[int, float]]:
    """Return a point and the turns of the longest loop of each level that winds once round."""
    size = len(found.level)
    graph = coo_array((np.ones(len(found.start), np.int8), (found.start, found.end)), shape=(size, size))
    loops, loop = connected_components(graph, directed=False)
    along = loop[found.start]
    turns = np.bincount(along, wrapped(found.angle[found.end] - found.angle[found.start]), loops) / (2 * np.pi)
    length = np.linalg.norm(found.position[found.end] - found.position[found.start], axis=1)
    length = np.bincount(along, length, loops)
    first, level = np.zeros(loops, int), np.zeros(loops, int)
    first[loop], level[loop] = np.arange(size), found.level
    once = np.flatnonzero(np.abs(np.abs(turns) - 1.0) < _ROUND)
    order = once[np.lexsort((-length[once], level[once]))]
    chosen = order[np.unique(level[order], return_index=True)[1]]
    return [(int(first[k]), float(turns[k])) for k in chosen]


def _walk(chain_to: list[int], first: int) -> list[int]:
    """Return the points of a loop in order; none if it is open."""
    loop, at = [first], chain_to[first]
    while at != first and at >= 0:
        loop.append(at)
        at = chain_to[at]
    return loop if at == first else []


def _resample(points: np.ndarray, angle: np.ndarray, sectors: int, by_length: float) -> np.ndarray:
    """Return points of a closed polyline, and v, at even steps of a blend of v and length, shape (sectors, 4).

    The first step is at 0.
    """
    closed = np.concatenate([points, points[:1]])
    turn = np.r_[0.0, np.cumsum(wrapped(np.diff(np.r_[angle, angle[0]])))]
    turn = 0.5 * (np.maximum.accumulate(turn) + np.minimum.accumulate(turn[::-1])[::-1])
    turn *= 2 * np.pi / turn[-1]
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))]
    length *= 2 * np.pi / length[-1]
    place = (1.0 - by_length) * turn + by_length * (length + np.mean(turn - length))
    place += 1e-9 * np.arange(len(place))
    wanted = (np.arange(sectors) * 2 * np.pi / sectors - angle[0] - place[0]) % (2 * np.pi) + place[0]
    v = np.interp(wanted, place, angle[0] + turn)
    even = np.arange(sectors) * 2 * np.pi / sectors
    return np.stack([*(np.interp(wanted, place, closed[:, k]) for k in range(3)), even + wrapped(v - even)], 1)
