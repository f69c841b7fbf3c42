# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of a wall on its own: tetrahedra, distances of its rings and loops, room for the scope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.measures import tet_quality, tet_volumes
from arcgym.anatomy.stage.types import WallMesh
from arcgym.anatomy.validation.checks import Check

MIN_TET_VOLUME = 1e-12
"""Least volume of a wall tetrahedron [m^3]."""

MIN_TET_QUALITY = 0.04
"""Least mean-ratio quality of a wall tetrahedron. A 2 mm wall with 12 mm edges has about 0.2; 0 is flat."""


@dataclass(frozen=True)
class WallBounds:
    """Bounds of a wall that depend on who made it; the defaults are those of any wall."""

    ring_distance: float = 0.0
    """Least distance of neighboring rings [m]."""
    loop_gap: float = 0.0
    """Least gap between the walls of two loops [m]."""
    lumen_radius: float = 0.0066
    """Least radius of the lumen [m]: that of a colonoscope's head."""


def check_wall(wall: WallMesh, bounds: WallBounds | None = None) -> list[Check]:
    """Check the wall: tetrahedra, gap between loops, room for the scope."""
    bounds = bounds or WallBounds()
    volume, quality = tet_volumes(wall.points, wall.tets), tet_quality(wall.points, wall.tets)
    return [
        Check("least tetrahedron volume [m^3]", float(volume.min()), MIN_TET_VOLUME, at_least=True),
        Check("least tetrahedron quality", float(quality.min()), MIN_TET_QUALITY, at_least=True),
        Check("least distance of rings [m]", ring_distance(wall), bounds.ring_distance, at_least=True),
        Check("gap between loops [m]", loop_gap(wall), bounds.loop_gap, at_least=True),
        Check("least lumen radius [m]", float(ring_radii(wall).min()), bounds.lumen_radius, at_least=True),
    ]


def ring_centers(wall: WallMesh) -> np.ndarray:
    """Return the mean position of each ring's inner vertices [m], shape (R, 3)."""
    inner = wall.points[wall.layer == 0]
    return inner.reshape(wall.num_rings, -1, 3).mean(1)


def ring_distance(wall: WallMesh) -> float:
    """Return the least distance between vertices of neighboring rings at the middle of the wall [m]."""
    points = wall.points.reshape(wall.layer.max() + 1, wall.num_rings, -1, 3).astype(float)
    return float(np.linalg.norm(np.diff(points.mean(0), axis=0), axis=-1).min())


def ring_radii(wall: WallMesh) -> np.ndarray:
    """Return the least distance from each ring's center to its inner edges [m], shape (R,)."""
    ring = wall.points[wall.layer == 0].reshape(wall.num_rings, -1, 3).astype(float)
    offset = ring - ring.mean(1, keepdims=True)
    edge = np.roll(offset, -1, axis=1) - offset
    share = np.clip(-(offset * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-18), 0.0, 1.0)
    return np.linalg.norm(offset + share[..., None] * edge, axis=-1).min(1)


def loop_gap(wall: WallMesh, reach: float = 0.05) -> float:
    """Return the least distance between outer vertices of different loops [m]; ``reach`` if there are none so near.

    Two rings belong to different loops when the way along the centerline is more than 1.7 times what their radii
    and a straight wall between them would need.
    """
    outer = wall.layer == wall.layer.max()
    points, ring = wall.points[outer], wall.ring[outer]
    width = np.linalg.norm(points - ring_centers(wall)[ring], axis=1)
    radius = np.array([width[ring == k].max() for k in range(wall.num_rings)])
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    a, b = ring[pairs[:, 0]], ring[pairs[:, 1]]
    other = np.abs(wall.ring_arc[a] - wall.ring_arc[b]) > 1.7 * (radius[a] + radius[b])
    distance = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)[other]
    return float(distance.min()) if len(distance) else reach
