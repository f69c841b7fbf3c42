# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turn and move a colon from the file's axes to the stage's: anal verge at the origin, canal upright."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import FRAMES
from arcgym.anatomy.importing.grid import Grid
from arcgym.anatomy.importing.measuring import Measured
from arcgym.anatomy.importing.orientation import Orientation
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.importing.smooth_centerline import plain_curve

_FARTHEST_LANDMARK = 0.06
"""Largest distance of a given landmark from the centerline [m]."""

_CANAL = 0.015
"""Length of the anal canal that is turned as a whole [m]."""

_CANAL_BEND = (0.020, 0.055)
"""Least and largest length behind it over which the turn fades [m]."""

_CANAL_CURVATURE = 10.0
"""Curvature that the turn adds there, between these lengths [1/m]."""


def turned_grid(grid: Grid, path: np.ndarray, rotation: np.ndarray) -> tuple[Grid, np.ndarray]:
    """Turn a grid and a path by a rotation that maps axes onto axes."""
    axes = np.abs(rotation).argmax(1)
    signs = rotation[np.arange(3), axes]
    values, origin = grid.values.transpose(axes), signs * grid.origin[axes]
    for axis in np.flatnonzero(signs < 0):
        values = np.flip(values, int(axis))
        origin[axis] -= (values.shape[axis] - 1) * grid.spacing
    return Grid(np.ascontiguousarray(values), origin, grid.spacing), path @ rotation.T


def place(measured: Measured) -> tuple[Curve, Measured, float]:
    """Return the curve in the stage's frame, what was measured in its frames, and the turn of the canal [rad]."""
    old = measured.curve
    points, angle = turn_canal_upright(old.points)
    curve = plain_curve(points)
    at = np.array(0.5 * curve.length)
    _, normal, binormal = old.frame(at)
    turned = curve.frame(at)[1]
    columns = measured.radius.shape[1]
    turn = np.arctan2(turned @ binormal, turned @ normal) * columns / (2 * np.pi)
    radius, dome = (_rolled(values, float(turn)) for values in (measured.radius, measured.dome))
    s = measured.s * curve.length / old.length
    return curve, Measured(old, s, radius, measured.dome_row, dome), angle


def _rolled(values: np.ndarray, columns: float) -> np.ndarray:
    """Shift columns round by a fraction, shape kept."""
    whole = int(np.floor(columns))
    share = columns - whole
    return (1 - share) * np.roll(values, -whole, 1) + share * np.roll(values, -whole - 1, 1)


def given_landmarks(settings: ImportSettings, curve: Curve, rotation: np.ndarray, length: float) -> dict[str, float]:
    """Return the arc length [m] of the landmarks that the caller knows, of positions the nearest."""
    arcs = {}
    for name, position in settings.landmarks.items():
        if isinstance(position, float | int):
            arcs[name] = float(position)
            continue
        distance = np.linalg.norm(curve.points - 1e-3 * np.array(position) @ rotation.T, axis=1)
        if distance.min() > _FARTHEST_LANDMARK:
            raise ColonImportError(
                f"The landmark {name} at {position} mm is {1e3 * distance.min():.0f} mm away from the centreline",
                "Pass --landmark NAME=X,Y,Z in millimetres on the same axes as --anus.",
            )
        arcs[name] = float(curve.s[distance.argmin()]) * length / curve.length
    return arcs


def describe_transform(orientation: Orientation, measured: Measured, curve: Curve, canal: float) -> dict[str, Any]:
    """Describe how the file's coordinates became the stage's."""
    half = np.array(0.5 * curve.length)
    offset = curve.position(half) - measured.curve.position(half * measured.curve.length / curve.length)
    return {
        "sourceFrame": orientation.frame,
        "rotationFromSource": FRAMES[orientation.frame].ravel().tolist(),
        "translationAfterRotation": [round(float(value), 6) for value in offset],
        "canalTurnedDegrees": round(float(np.degrees(canal)), 1),
        "transformNote": "stage = rotation * source [m] + translation; the anal canal is drawn anew along +Z",
    }


def turn_canal_upright(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Turn the first centimetres until the anal canal rises along +Z, and put the anal verge at the origin.

    Returns:
        The new points [m] and the angle by which the canal was turned [rad]; lengths are kept, and everything beyond
        4 cm, or 7 cm if it was turned far, only moves.
    """
    edge = np.diff(points, axis=0)
    length = np.linalg.norm(edge, axis=1)
    arc = np.cumsum(length) - 0.5 * length
    first = edge[arc < _CANAL].sum(0)
    upright, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [first])
    bend = float(np.clip(upright.magnitude() / _CANAL_CURVATURE, *_CANAL_BEND))
    fade = 1.0 - smooth_step(0.0, 1.0, (arc - _CANAL) / bend)
    turned = Rotation.from_rotvec(fade[:, None] * upright.as_rotvec()).apply(edge)
    return np.concatenate([np.zeros((1, 3)), np.cumsum(turned, axis=0)]), float(upright.magnitude())
