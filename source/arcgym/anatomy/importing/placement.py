# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turn and move a colon from the file's axes to the stage's, whose origin is the anal verge."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import FRAMES
from arcgym.anatomy.importing.orientation import Orientation
from arcgym.anatomy.importing.settings import ImportSettings
from arcgym.anatomy.voxel_grid import Grid

_FARTHEST_LANDMARK = 0.06
"""Largest distance of a given landmark from the centerline [m]."""


def turned_grid(grid: Grid, path: np.ndarray, rotation: np.ndarray) -> tuple[Grid, np.ndarray]:
    """Turn a grid and a path by a rotation that maps axes onto axes."""
    axes = np.abs(rotation).argmax(1)
    signs = rotation[np.arange(3), axes]
    values, origin = grid.values.transpose(axes), signs * grid.origin[axes]
    for axis in np.flatnonzero(signs < 0):
        values = np.flip(values, int(axis))
        origin[axis] -= (values.shape[axis] - 1) * grid.spacing
    return Grid(np.ascontiguousarray(values), origin, grid.spacing), path @ rotation.T


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
                f"The landmark {name} at {position} mm is {1e3 * distance.min():.0f} mm away from the centerline",
                "Pass --landmark NAME=X,Y,Z in millimeters on the same axes as --anus.",
            )
        arcs[name] = float(curve.s[distance.argmin()]) * length / curve.length
    return arcs


def describe_transform(orientation: Orientation, shift: np.ndarray) -> dict[str, Any]:
    """Describe how the file's coordinates became the stage's; ``shift`` takes the anal verge to the origin [m]."""
    return {
        "sourceFrame": orientation.frame,
        "rotationFromSource": FRAMES[orientation.frame].ravel().tolist(),
        "translationAfterRotation": [round(float(value), 6) for value in shift],
        "transformNote": "stage = rotation * source [m] + translation; the anal canal is drawn anew along +Z",
    }
