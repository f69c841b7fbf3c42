# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One world's wall as numbers, in numpy, and as Warp structs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import warp as wp

from arcgym.assets.anchors import AnchorSprings
from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim.wall.anchor_kernels import Anchors
from arcgym.sim.wall.ring_modes import ElasticPart
from arcgym.sim.wall.wall_kernels import WallNodes


@dataclass(frozen=True)
class SolidParameters:
    """Tetrahedral wall of T tets."""

    tets: np.ndarray
    """Vertex indices, shape (T, 4)."""
    parts: tuple[ElasticPart, ...]
    """Rest stiffness for unit moduli."""


@dataclass(frozen=True)
class ShellParameters:
    """Shell of triangles and hinges."""

    geometry: ShellGeometry
    """Rest geometry."""
    parts: tuple[ElasticPart, ...]
    """Rest stiffness for unit moduli."""


@dataclass(frozen=True)
class WallParameters:
    """One world's wall, V vertices."""

    points: np.ndarray
    """Rest positions [m], shape (V, 3)."""
    elements: SolidParameters | ShellParameters
    """Its elements."""
    moduli: tuple[float, float, float]
    """Shear, second Lamé parameter, bending: solid [Pa, Pa, -] or shell [N/m, N/m, N m]."""
    mass: np.ndarray
    """Vertex masses [kg], shape (V,)."""
    mobile: np.ndarray
    """Whether each vertex moves, shape (V,), bool."""
    anchor: AnchorSprings
    """Spring of each vertex to its rest position."""
    ring: np.ndarray
    """Ring of each vertex, shape (V,)."""
    thickness: float
    """Distance between the outermost vertices of two stretches that touch [m]: a shell's thickness, 0 for a solid."""
    colors: list[np.ndarray]
    """Vertices that share no element, colour by colour."""


def wall_nodes(wall: WallParameters, device: str) -> WallNodes:
    """Copy the vertices to the device."""
    nodes = WallNodes()
    nodes.mass = wp.array(wall.mass, dtype=float, device=device)
    nodes.mobile = wp.array(wall.mobile.astype(np.int32), dtype=int, device=device)
    nodes.anchors = wall_anchors(wall.points, wall.anchor, device)
    return nodes


def wall_anchors(points: np.ndarray, springs: AnchorSprings, device: str) -> Anchors:
    """Copy the anchor springs to ``points`` [m], shape (V, 3), to the device."""
    anchors = Anchors()
    for name in ("stiffness", "loose", "slack"):
        setattr(anchors, name, wp.array(getattr(springs, name), dtype=float, device=device))
    anchors.rest = wp.array(points, dtype=wp.vec3, device=device)
    return anchors
