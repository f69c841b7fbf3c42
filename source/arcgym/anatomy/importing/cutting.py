# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Cut attached lumen off at its neck, and fill the hole that a rectal tube leaves; both change the grid."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from arcgym.anatomy.importing.attached_lumen import AttachedLumen
from arcgym.anatomy.importing.cleaning import in_millimeters
from arcgym.anatomy.importing.tree import caliber
from arcgym.anatomy.voxel_grid import Grid

_MARGIN = 0.006
"""How far beyond the piece's largest clearance voxels are looked at [m]."""

_FOLDS = 1.3
"""Largest lumen radius over the clearance that is taken for the colon's: folds stand between them."""

_TUBE_REACH = 0.12
"""Half the edge of the box round the anus in which holes are filled [m]."""

_TUBE_SECTION = 3e-4
"""Largest section of a hole that is filled [m^2], about that of a disc of 20 mm."""


def cut_off(grid: Grid, attached: list[AttachedLumen], path: np.ndarray, clearance: np.ndarray) -> list[dict[str, Any]]:
    """Set the voxels of attached pieces to 0, in place.

    A voxel goes with the piece whose wall it is deeper within: the colon's or that of what hangs on it.

    Args:
        grid: The lumen; its values are changed.
        attached: What to cut off.
        path: Middle line of the colon [m], shape (n, 3).
        clearance: Distance from it to the wall [m], shape (n,).

    Returns:
        What was cut, for the report.
    """
    colon, width = cKDTree(path), np.minimum(caliber(clearance, path), _FOLDS * clearance)
    reports = []
    for piece in attached:
        reach = float(piece.clearance.max()) + _MARGIN
        low = np.maximum(np.floor(grid.index(piece.points.min(0) - reach)).astype(int), 0)
        high = np.minimum(np.ceil(grid.index(piece.points.max(0) + reach)).astype(int) + 1, grid.values.shape)
        box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
        index = np.argwhere(grid.values[box] > 0) + low
        points = grid.points(index)
        away, nearest = cKDTree(piece.points).query(points, distance_upper_bound=1.4 * reach)
        near = np.isfinite(away)
        index, away, nearest = index[near], away[near], nearest[near]
        depth = away - caliber(piece.clearance, piece.points)[nearest]
        distance, own = colon.query(points[near])
        gone = depth < distance - width[own]
        lumen = grid.values[tuple(index[gone].T)] > 0.5
        grid.values[tuple(index[gone].T)] = 0.0
        reports.append(as_report(piece, float(lumen.sum()) * grid.spacing**3))
    if attached:
        _keep_connected(grid, path)
    return reports


def as_report(piece: AttachedLumen, volume: float | None = None) -> dict[str, Any]:
    """Return kind, size, volume [m^3] if known, and place of a piece for the report."""
    figures = {
        "kind": piece.kind,
        "length_mm": round(1e3 * piece.length),
        "caliber_mm": round(2e3 * float(np.median(caliber(piece.clearance, piece.points))), 1),
        "neck_mm": round(2e3 * piece.neck, 1),
        "place_mm": in_millimeters(piece.points[0]),
    }
    return figures if volume is None else {**figures, "volume_ml": round(1e6 * volume, 1)}


def _keep_connected(grid: Grid, path: np.ndarray) -> None:
    """Drop what the cut has left without a way to the colon."""
    labels, _ = ndimage.label(grid.values > 0)
    index = np.rint(grid.index(path)).astype(int)
    names = labels[tuple(index.T)]
    main = np.bincount(names[names > 0]).argmax()
    grid.values[labels != main] = 0.0


def fill_tube(grid: Grid, anus: np.ndarray, axis: int = 2) -> float:
    """Fill, in place, holes in cross-sections of the rectum: a tube's wall and its own lumen, and so its balloon.

    Args:
        grid: The lumen in the patient's frame.
        anus: Anal end [m], shape (3,).
        axis: Axis across which the sections lie.

    Returns:
        Filled volume [m^3].
    """
    low = np.maximum(np.floor(grid.index(anus - _TUBE_REACH)).astype(int), 0)
    high = np.minimum(np.ceil(grid.index(anus + _TUBE_REACH)).astype(int), grid.values.shape)
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    part = np.moveaxis(grid.values[box], axis, 0)
    before = int((part > 0.5).sum())
    for section in part:
        inside = section > 0.5
        labels, count = ndimage.label(ndimage.binary_fill_holes(inside) & ~inside)
        area = np.bincount(labels.ravel(), minlength=count + 1) * grid.spacing**2
        small = (area < _TUBE_SECTION) & (np.arange(count + 1) > 0)
        section[small[labels]] = 1.0
    part[ndimage.binary_fill_holes(part > 0.5) & (part <= 0.5)] = 1.0
    return (int((part > 0.5).sum()) - before) * grid.spacing**3
