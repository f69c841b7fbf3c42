# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Level curves of a conformal map as rings of evenly chosen points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from arcgym.anatomy.meshing.conformal_map import ConformalMap
from arcgym.anatomy.meshing.triangle_surface import edge_ends, edge_keys

_ROUND = 0.5
"""By how much the turns of a main loop in v may differ from one. Where they do, v's cut runs through a handle beside
it, such as a hole in a fold; the ring then goes by its own flux and is turned to fit its neighbor."""


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
    flux: np.ndarray
    """Gradient of u along each piece times its length, shape (m,): its share of a full turn."""


def level_rings(
    mapped: ConformalMap, levels: np.ndarray, sectors: int, by_length: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the main loop of each level curve, the one through which most of the flux of u goes, as points.

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
    following, flux = np.full(len(found.level), -1), np.zeros(len(found.level))
    following[found.start], flux[found.start] = found.end, found.flux
    chain_to = following.tolist()
    rings, placed = np.full((len(levels), sectors, 4), np.nan), np.zeros(len(levels), bool)
    main = _main_loops(found)
    forward = np.sign(sum(turns for _, turns in main)) or 1.0
    for first, turns in main:
        loop = _walk(chain_to, first)
        if len(loop) < 3:
            continue
        level, share = found.level[first], flux[loop]
        angle, placed[level] = found.angle[loop], abs(turns * forward - 1.0) < _ROUND
        if not placed[level]:
            angle = forward * 2 * np.pi * (np.cumsum(share) - share) / share.sum()
        step = 1 if forward > 0 else -1
        rings[level] = _resample(found.position[loop][::step], angle[::step], sectors, by_length)
    return *_aligned(rings, placed), np.isfinite(rings[:, 0, 0])


def _aligned(rings: np.ndarray, placed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and v of rings; those without a place on the scale of v are turned to fit the nearest one."""
    have = np.flatnonzero(placed)
    for k in np.flatnonzero(~placed & np.isfinite(rings[:, 0, 0])):
        if len(have):
            near = rings[have[np.abs(have - k).argmin()], :, :3]
            apart = [((np.roll(rings[k, :, :3], j, 0) - near) ** 2).sum() for j in range(rings.shape[1])]
            rings[k, :, :3] = np.roll(rings[k, :, :3], int(np.argmin(apart)), 0)
    return rings[..., :3], rings[..., 3]


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Return angles in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _find_crossings(mapped: ConformalMap, levels: np.ndarray) -> _Crossings:
    faces, u, edge_of = mapped.faces, mapped.u, edge_keys(mapped.faces, len(mapped.u))
    low, high = (np.searchsorted(levels, bound, "right") for bound in (u[faces].min(1), u[faces].max(1)))
    count = high - low
    face = np.repeat(np.arange(len(faces)), count)
    level = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
    above = u[faces[face]] >= levels[level][:, None]
    leaving, entering = above & ~np.roll(above, -1, 1), ~above & np.roll(above, -1, 1)
    key = level.astype(np.int64) * len(u) ** 2
    start, end = (key + edge_of[face, mark.argmax(1)] for mark in (entering, leaving))
    node, place = np.unique(np.concatenate([start, end]), return_inverse=True)
    number, ends = node // len(u) ** 2, edge_ends(node % len(u) ** 2, len(u))
    share = (levels[number] - u[ends[:, 0]]) / (u[ends[:, 1]] - u[ends[:, 0]])
    a, b = mapped.points[ends[:, 0]], mapped.points[ends[:, 1]]
    position = a + share[:, None] * (b - a)
    first, last = place.reshape(2, -1)
    flux = _slopes(mapped)[face] * np.linalg.norm(position[last] - position[first], axis=1)
    angle = mapped.v[ends[:, 0]] + share * wrapped(mapped.v[ends[:, 1]] - mapped.v[ends[:, 0]])
    return _Crossings(number, position, angle, first, last, flux)


def _slopes(mapped: ConformalMap) -> np.ndarray:
    """Return the length of the gradient of u on each triangle [1/m], shape (F,)."""
    corner, u = mapped.points[mapped.faces], mapped.u[mapped.faces]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    rising = sum(u[:, k, None] * (corner[:, (k + 2) % 3] - corner[:, (k + 1) % 3]) for k in range(3))
    return np.linalg.norm(rising, axis=1) / np.maximum(area, 1e-18)


def _main_loops(found: _Crossings) -> list[tuple[int, float]]:
    """Return a point of the loop of each level that has the largest flux, and its turns in v."""
    size = len(found.level)
    graph = coo_array((np.ones(len(found.start), np.int8), (found.start, found.end)), shape=(size, size))
    loops, loop = connected_components(graph, directed=False)
    along = loop[found.start]
    turns = np.bincount(along, wrapped(found.angle[found.end] - found.angle[found.start]), loops) / (2 * np.pi)
    flux = np.bincount(along, found.flux, loops)
    first, level = np.zeros(loops, int), np.zeros(loops, int)
    first[loop], level[loop] = np.arange(size), found.level
    order = np.lexsort((-flux, level))
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
