# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surfaces: the measured radii on a fine grid, closed over the caecum and skinned to the wall."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import map_coordinates

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.polar import bounded
from arcgym.anatomy.importing.wall_fitting import FittedWall
from arcgym.anatomy.measures import face_normals
from arcgym.anatomy.meshing.surface_grid import (
    dome_texture,
    grid_triangles,
    skin_to_rings,
    smooth_normals,
    tube_texture,
)
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import VisualMesh

_LEAST_RADIUS = 0.005
"""Least distance of the visual surface from the centerline [m]."""

_DOME_STEPS = 10
"""Rows of the dome of the cecum."""


def fit_visual(
    curve: Curve, s: np.ndarray, radius: np.ndarray, dome: np.ndarray, fitted: FittedWall, spacing: float, columns: int
) -> VisualMesh:
    """Sample the measured surface, moved along with the wall where that was widened or narrowed.

    Args:
        curve: Centreline.
        s: Arc length of the measured cross-sections, up to where the dome of the caecum begins [m], shape (n,).
        radius: Measured radii [m], shape (n, k).
        dome: Radii measured from the last of these centres, from across the curve to along it, shape (m, k).
        fitted: The wall.
        spacing: Distance of the cross-sections [m].
        columns: Points around.
    """
    rows = np.linspace(0.0, s[-1], round(s[-1] / spacing) + 1)
    theta = np.linspace(0.0, 2 * np.pi, columns + 1)
    polar = np.linspace(0.0, 0.5 * np.pi, _DOME_STEPS + 1)
    along = np.concatenate([rows, s[-1] + (curve.length - s[-1]) * np.sin(polar)])
    tube = _resampled(s, radius, rows, theta[:-1])
    cap = _resampled(np.linspace(0.0, 0.5 * np.pi, len(dome)), dome, polar, theta[:-1])
    cap[-1] = cap[-1].mean()
    fade = np.r_[np.ones(len(rows)), np.cos(polar)][:, None]
    rho = np.maximum(np.concatenate([tube, cap]) + fade * _change(fitted, along, theta[:-1]), _LEAST_RADIUS)
    rho[: len(rows)] = bounded(curve, rows, rho[: len(rows)])
    rho[len(rows)] = rho[len(rows) - 1]
    rho = np.concatenate([rho, rho[:, :1]], 1)
    points = _positions(curve, rows, polar, theta, rho)
    faces = np.concatenate(
        [grid_triangles(len(rows), columns + 1), grid_triangles(len(polar), columns + 1) + len(rows) * (columns + 1)]
    )
    faces = faces[np.linalg.norm(face_normals(points, faces), axis=1) > 1e-12]
    arc, angle = np.broadcast_arrays(along[:, None], theta)
    indices, weights = skin_to_rings(arc.ravel(), angle.ravel(), fitted.wall.ring_arc, fitted.wall.num_sectors)
    return VisualMesh(
        points=points,
        faces=faces,
        normals=smooth_normals(points, faces),
        uv=_texture_coordinates(curve, rows, polar, theta, rho).astype(np.float32),
        tint=np.zeros(len(points), np.float32),
        skin_indices=indices,
        skin_weights=weights,
    )


def _texture_coordinates(
    curve: Curve, rows: np.ndarray, polar: np.ndarray, theta: np.ndarray, rho: np.ndarray
) -> np.ndarray:
    """Return u and v of tube and dome, each stretch in the band of its vessels, shape (M, 2)."""
    bounds = {name: curve.bounds(name) for name in SEGMENTS}
    s, angle = (grid.ravel() for grid in np.meshgrid(rows, theta, indexing="ij"))
    rim = float(rho[len(rows)].mean())
    lift, turn = (grid.ravel() for grid in np.meshgrid(polar, theta, indexing="ij"))
    meridian = (0.5 * np.pi - lift) * 0.5 * (rim + float(rho[-1].mean()))
    return np.concatenate([tube_texture(s, angle, bounds), dome_texture(meridian, turn, rim)])


def _resampled(s: np.ndarray, values: np.ndarray, rows: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Interpolate values on a grid that closes around, shape (len(rows), len(theta))."""
    at = np.interp(rows, s, np.arange(len(s)))
    column = theta * values.shape[1] / (2 * np.pi)
    index = np.stack(np.meshgrid(at, column, indexing="ij"))
    wrapped = np.concatenate([values, values[:, :1]], 1)
    return map_coordinates(wrapped, index, order=1, mode="nearest")


def _change(fitted: FittedWall, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    return _resampled(fitted.wall.ring_arc, fitted.shift, s, theta)


def _positions(curve: Curve, rows: np.ndarray, polar: np.ndarray, theta: np.ndarray, rho: np.ndarray) -> np.ndarray:
    """Return the vertices of tube and dome [m], those of seam and rim the same twice, shape (M, 3), float32."""
    theta = np.where(theta > 2 * np.pi - 1e-9, 0.0, theta)
    center = np.r_[rows, np.full(len(polar), rows[-1])]
    lift = np.r_[np.zeros(len(rows)), polar]
    tangent, flat = curve.frame(center)[0], curve.outwards(center[:, None], theta)
    direction = np.cos(lift)[:, None, None] * flat + np.sin(lift)[:, None, None] * tangent[:, None]
    points = curve.position(center)[:, None] + rho[..., None] * direction
    return points.reshape(-1, 3).astype(np.float32)
