# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The wall as a thin shell: one layer of triangles half way through a wall's two layers of vertices."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.stage.types import WallMesh


@dataclass(frozen=True)
class ShellMesh:
    """Mid-surface of a wall, V vertices on the same rings and sectors as each of the wall's layers."""

    points: np.ndarray
    """Rest positions [m], shape (V, 3), float32."""
    triangles: np.ndarray
    """Vertex indices, normals from the lumen into the wall, shape (F, 3), int32."""
    thickness: float
    """Wall thickness [m]; the lumen's surface is half of it inwards."""
    anchor: np.ndarray
    """0 free, 1 elastic attachment, 2 fixed, shape (V,), int32."""
    segment: np.ndarray
    """Index into ``SEGMENTS``, shape (V,), int32."""
    ring: np.ndarray
    """Ring number along the centerline, shape (V,), int32."""
    layer: np.ndarray
    """All 0: the only layer is also the lumen side, shape (V,), int32."""
    frame_neighbors: np.ndarray
    """Next ring, previous ring, next around, previous around, shape (V, 4), int32."""
    ring_arc: np.ndarray
    """Arc length of each ring along the centerline at rest [m], shape (R,), float32."""


def wall_thickness(wall: WallMesh) -> float:
    """Median distance of the outer from the inner vertices [m].

    Raises:
        ValueError: If the wall has not two layers of equally many vertices.
    """
    inner, outer = _layers(wall)
    return float(np.median(np.linalg.norm(wall.points[outer] - wall.points[inner], axis=1)))


def mid_surface(wall: WallMesh, thickness: float) -> ShellMesh:
    """Shell of a given thickness whose lumen side is the wall's.

    Args:
        wall: Wall with an inner and an outer layer, paired by order.
        thickness: Thickness of the shell [m]; that of ``wall`` or another.

    Raises:
        ValueError: If the wall has not two layers of equally many vertices.
    """
    inner, outer = _layers(wall)
    outwards = wall.points[outer] - wall.points[inner]
    outwards = outwards / np.linalg.norm(outwards, axis=1, keepdims=True)
    return ShellMesh(
        points=(wall.points[inner] + 0.5 * thickness * outwards).astype(np.float32),
        triangles=inner_faces(wall.tets, wall.layer),
        thickness=thickness,
        anchor=np.maximum(wall.anchor[inner], wall.anchor[outer]),
        segment=wall.segment[inner],
        ring=wall.ring[inner],
        layer=wall.layer[inner],
        frame_neighbors=wall.frame_neighbors[inner],
        ring_arc=wall.ring_arc,
    )


def on_average(shell: ShellMesh) -> ShellMesh:
    """Return a shell whose faces lie on the surface on average, for one whose vertices lie on it.

    The faces between vertices of a curved surface cut its bends: those around a lumen make it narrower, by a twelfth
    of the square of their width times the curvature. A twelfth of the second differences along and around, taken off
    every vertex along its normal, puts them back. To that order it is the best fit by such faces: in least squares
    vertices c of a surface f obey c + d^2 c / 6 = f + d^2 f / 12, with the second differences d^2. Vertices without a
    neighbor on one side, at an end, count that direction as straight.
    """
    points, own = shell.points.astype(float), np.arange(len(shell.points))
    shift, sides = np.zeros_like(points), []
    for one, other in (shell.frame_neighbors[:, :2].T, shell.frame_neighbors[:, 2:].T):
        inner = ((one != own) & (other != own))[:, None]
        shift += np.where(inner, points[one] - 2.0 * points + points[other], 0.0)
        sides.append(points[one] - points[other])
    normal = np.cross(*sides)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    moved = points - (shift * normal).sum(axis=1, keepdims=True) / 12.0 * normal
    return replace(shell, points=moved.astype(np.float32))


def _layers(wall: WallMesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the inner and of the outer layer, paired; the inner ones are the first."""
    inner, outer = np.flatnonzero(wall.layer == 0), np.flatnonzero(wall.layer == 1)
    first = np.array_equal(inner, np.arange(len(inner)))
    if not first or len(inner) != len(outer) or len(inner) + len(outer) != len(wall.layer):
        raise ValueError(
            f"A shell needs a wall of two layers of equally many vertices, the inner one first; this wall has "
            f"{np.bincount(wall.layer).tolist()} vertices in its layers. Use ColonCfg(wall_model='solid')."
        )
    return inner, outer
