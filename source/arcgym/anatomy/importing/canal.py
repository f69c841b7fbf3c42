# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The anal canal as a scope's head needs it: straight up, open, and blended into the rectum.

On CT it is collapsed or held open by a tube, and the way through what is labeled there turns by right angles within
3 cm. The last centimeters of the lumen are drawn anew: a straight tube along +Z, an arc, and the rectum's own way on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from arcgym.anatomy.head_drawing import other_loops
from arcgym.anatomy.polyline import resample, smooth
from arcgym.anatomy.tubes import WALL, box_near, draw_tube, padded_for
from arcgym.anatomy.voxel_grid import Grid


@dataclass(frozen=True)
class CanalSettings:
    """Size of the canal. Our choices where nothing else is said."""

    radius: float = 0.0108
    """Radius of the tube [m]: a wall of 14 sectors then leaves more than 10 mm."""
    straight: float = 0.030
    """Length of the straight part [m]; the anatomical anal canal is 3 to 4 cm long (Gray's Anatomy)."""
    bend_radius: tuple[float, ...] = (0.036, 0.048, 0.070)
    """Radii of the arc that are tried [m]; smoothing takes some of it, and 30 mm have to be left."""
    joint: tuple[float, float] = (0.030, 0.110)
    """Range of the found way's arc length in which the new one joins it [m]."""
    largest_turn: float = 1.9
    """Largest angle of the arc [rad]."""
    funnel: tuple[float, float] = (0.020, 0.9)
    """Length from the verge from which more of the rectum is kept than the tube [m], and how fast it widens [m/m]."""
    beside: float = 1.4
    """Largest radius of what is kept of the rectum, over its radius where the new way joins it."""
    along: float = 0.015
    """How much farther from the joint, or nearer, what is kept may be along the found way than along the new [m]."""
    taper: float = 0.030
    """Length behind the joint over which the tube narrows to nothing where the rectum is narrower [m]."""
    least_bend: float = 0.032
    """Least bend radius from the verge to 2 cm behind the joint that is aimed at [m]."""


SETTINGS = CanalSettings()
_STEP = 0.001
"""Distance of the points of the way [m]."""

_END = 0.003
"""Distance of the points of the way that is returned [m]."""

_SMOOTHING = 4.0
"""Standard deviation of the smoothing of the way before its direction is taken, in steps of 1 mm."""

_WITHIN = 30
"""Steps within which the largest turn of the found way is taken."""

_BEYOND = 20
"""Steps behind the joint in which bends count as the canal's."""

_BENDS = 0.005
"""Standard deviation of the smoothing over which bend radii are taken [m], as in :mod:`arcgym.anatomy.bends`."""


@dataclass(frozen=True)
class Canal:
    """How the canal was drawn."""

    path: np.ndarray
    """The whole way, from the new anal verge [m], shape (n, 3)."""
    joint: float
    """Arc length of the found way from which on it is kept [m]."""
    length: float
    """Length of what replaces it [m]."""
    turn: float
    """Angle of the arc [rad]."""
    bend_radius: float
    """Radius of the arc [m]."""


def straighten_canal(grid: Grid, path: np.ndarray) -> tuple[Grid, np.ndarray, dict[str, float]]:
    """Draw the anal canal anew.

    Args:
        grid: The lumen in the patient's frame, +Z cranial.
        path: Way from the anus to the cecum [m], shape (n, 3).

    Returns:
        The changed lumen, the new way, and figures for the report: what was found there, and what was done.
    """
    way = resample(path, _STEP)
    canal = _plan(grid, way)
    new = canal.path[: round(canal.length / _STEP) + 1]
    out = padded_for(grid, new, SETTINGS.radius)
    _remove_old(out, way, canal.joint, new)
    behind = canal.path[len(new) : len(new) + round(SETTINGS.taper / _STEP)]
    radius = np.r_[np.full(len(new), SETTINGS.radius), SETTINGS.radius * np.linspace(1.0, 0.0, len(behind))]
    tube = np.concatenate([new, behind])
    keep_off = other_loops(grid, way, tube, SETTINGS.radius, np.array([0.0, canal.joint + SETTINGS.taper]))
    draw_tube(out, tube, radius, keep_off, flat_start=True)
    return out, resample(canal.path, _END), _figures(way, canal)


def _plan(grid: Grid, way: np.ndarray) -> Canal:
    """Return the new way that keeps nearest to the found one's length and place and runs into no other loop."""
    tangent = np.gradient(smooth(way, _SMOOTHING), axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    first, last = (round(value / _STEP) for value in SETTINGS.joint)
    reach = way[: last + 1]
    others = cKDTree(np.r_[other_loops(grid, way, reach, 0.05, _STEP * np.array([0, last])), [[9.0] * 3]])
    room = min(SETTINGS.radius + WALL, float(others.query(reach)[0].min()))
    best, found = np.inf, None
    for joint in range(first, min(last, len(way) // 4), 2):
        for bend_radius in SETTINGS.bend_radius:
            new, turn = _arc_and_straight(way[joint], tangent[joint], bend_radius)
            if turn > SETTINGS.largest_turn:
                continue
            length = _STEP * (len(new) - 1)
            cost = abs(length - _STEP * joint) + 0.3 * float(np.linalg.norm(new[0] - way[0])) + 0.2 * _STEP * joint
            cost += 0.2 * max(0.0, 0.05 - bend_radius)
            cost += 10.0 * max(0.0, room - float(others.query(new)[0].min()))
            path = np.concatenate([new, way[joint + 1 :]])
            cost += 2.0 * max(0.0, SETTINGS.least_bend - least_bend_radius(path[: len(new) + _BEYOND]))
            if cost < best:
                best, found = cost, Canal(path, _STEP * joint, length, turn, bend_radius)
    assert found is not None, "the first joint is always tried"
    return found


def _arc_and_straight(start: np.ndarray, tangent: np.ndarray, radius: float) -> tuple[np.ndarray, float]:
    """Return points 1 mm apart from a new verge, along +Z and round an arc, to ``start``; and the arc's angle [rad]."""
    up = np.array([0.0, 0.0, 1.0])
    turn = float(np.arccos(np.clip(tangent @ up, -1.0, 1.0)))
    side = tangent - (tangent @ up) * up
    side = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([1.0, 0.0, 0.0])
    total = radius * turn + SETTINGS.straight
    arc = np.linspace(0.0, total, round(total / _STEP) + 1)
    bent = np.maximum(arc - SETTINGS.straight, 0.0) / radius
    along = np.minimum(arc, SETTINGS.straight) + radius * np.sin(bent)
    points = along[:, None] * up + (radius * (1.0 - np.cos(bent)))[:, None] * side
    return points + (start - points[-1]), turn


def _remove_old(grid: Grid, way: np.ndarray, joint: float, new: np.ndarray) -> None:
    """Remove the lumen along the replaced part of the way, but for a funnel round the new one, in place."""
    index = np.argwhere(grid.values > 0)
    points = grid.points(index)
    here = np.linalg.norm(points - way[0], axis=1) < joint + 0.06
    index, points = index[here], points[here]
    below = joint - _STEP * cKDTree(way).query(points)[1]
    distance, nearest = cKDTree(new).query(points)
    start, slope = SETTINGS.funnel
    room = SETTINGS.radius + slope * np.maximum(_STEP * nearest - start, 0.0)
    room = np.minimum(room, SETTINGS.beside * _widest_near(grid, way, joint))
    elsewhere = np.abs(below - _STEP * (len(new) - 1 - nearest)) > SETTINGS.along
    gone = (below > 0) & ((distance > room) | (nearest == 0) | elsewhere)
    grid.values[tuple(index[gone].T)] = 0.0


def _widest_near(grid: Grid, way: np.ndarray, joint: float) -> float:
    """Return the largest distance to the wall within 2 cm of the joint along the way [m]."""
    near = round(joint / _STEP)
    points = way[max(near - _BEYOND, 0) : near + _BEYOND]
    box = box_near(grid, points, 0.04)
    distance = grid.spacing * distance_transform_edt(grid.values[box] > 0.5)
    index = np.rint(grid.index(points)).astype(int) - [side.start for side in box]
    return max(float(distance[tuple(np.clip(index, 0, np.array(distance.shape) - 1).T)].max()), SETTINGS.radius)


def least_bend_radius(points: np.ndarray) -> float:
    """Return the least bend radius of a way of points 1 mm apart, smoothed over 5 mm [m]."""
    soft = smooth(points, _BENDS / _STEP)
    first = np.gradient(soft, _STEP, axis=0)
    second = np.gradient(first, _STEP, axis=0)
    return float(1.0 / np.linalg.norm(second, axis=1)[2:-2].max(initial=1e-3))


def _figures(way: np.ndarray, canal: Canal) -> dict[str, float]:
    near = round(canal.joint / _STEP)
    tangent = np.gradient(smooth(way[: near + 2 * _WITHIN], _SMOOTHING), axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    turn = np.arccos(np.clip((tangent[_WITHIN:] * tangent[:-_WITHIN]).sum(1)[:near], -1.0, 1.0))
    return {
        "found_bend_radius_mm": round(1e3 * least_bend_radius(way[: round(canal.joint / _STEP) + _BEYOND]), 1),
        "found_turn_within_3_cm_deg": round(float(np.degrees(turn.max())), 1),
        "replaced_mm": round(1e3 * canal.joint, 1),
        "new_length_mm": round(1e3 * canal.length, 1),
        "turn_deg": round(float(np.degrees(canal.turn)), 1),
        "bend_radius_mm": round(1e3 * least_bend_radius(canal.path[: round(canal.length / _STEP) + _BEYOND]), 1),
        "verge_moved_mm": round(1e3 * float(np.linalg.norm(canal.path[0] - way[0])), 1),
    }
