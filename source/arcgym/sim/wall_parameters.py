# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One world's wall as numbers, in numpy, and as Warp structs."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
import warp as wp

from arcgym.assets.anchors import AnchorSprings
from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim import shell_kernels, solid_kernels
from arcgym.sim.anchor_kernels import Anchors
from arcgym.sim.ring_modes import ElasticPart
from arcgym.sim.wall_kernels import WallNodes
from arcgym.sim.wall_topology import vertex_entries


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
    """What it is made of."""
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
    colours: list[np.ndarray]
    """Vertices that share no element, colour by colour."""


def wall_nodes(wall: WallParameters, device: str) -> WallNodes:
    """Vertices on the device."""
    nodes = WallNodes()
    nodes.mass = wp.array(wall.mass, dtype=float, device=device)
    nodes.mobile = wp.array(wall.mobile.astype(np.int32), dtype=int, device=device)
    nodes.anchors = wall_anchors(wall.points, wall.anchor, device)
    return nodes


def wall_anchors(points: np.ndarray, springs: AnchorSprings, device: str) -> Anchors:
    """Anchor springs to ``points`` [m], shape (V, 3), on the device."""
    anchors = Anchors()
    for name in ("stiffness", "loose", "slack"):
        setattr(anchors, name, wp.array(getattr(springs, name), dtype=float, device=device))
    anchors.rest = wp.array(points, dtype=wp.vec3, device=device)
    return anchors


def wall_elements(wall: WallParameters, device: str) -> tuple[ModuleType, Any]:
    """Kernels for the wall's kind and its elements on the device."""
    if isinstance(wall.elements, ShellParameters):
        return shell_kernels, _shell_elements(wall.elements.geometry, len(wall.points), device)
    return solid_kernels, _solid_elements(wall.points, wall.elements.tets, device)


def _solid_elements(points: np.ndarray, tets: np.ndarray, device: str) -> solid_kernels.SolidElements:
    edges = (points[tets[:, 1:]] - points[tets[:, :1]]).transpose(0, 2, 1)
    start, entry = vertex_entries(tets, len(points))
    solid = solid_kernels.SolidElements()
    solid.tets = wp.array(tets, dtype=wp.vec4i, device=device)
    solid.inv_rest = wp.array(np.linalg.inv(edges), dtype=wp.mat33, device=device)
    solid.volume = wp.array(np.linalg.det(edges) / 6.0, dtype=float, device=device)
    solid.entry_start = wp.array(start, dtype=int, device=device)
    solid.entry = wp.array(entry, dtype=int, device=device)
    return solid


def _shell_elements(geometry: ShellGeometry, vertices: int, device: str) -> shell_kernels.ShellElements:
    shell = shell_kernels.ShellElements()
    shell.triangles = wp.array(geometry.triangles, dtype=wp.vec3i, device=device)
    shell.inv_rest = wp.array(geometry.inv_rest, dtype=wp.mat22, device=device)
    shell.area = wp.array(geometry.area, dtype=float, device=device)
    shell.hinges = wp.array(geometry.hinges, dtype=wp.vec4i, device=device)
    shell.rest_angle = wp.array(geometry.rest_angle, dtype=float, device=device)
    shell.weight = wp.array(geometry.weight, dtype=float, device=device)
    for name, elements in (("triangle", geometry.triangles), ("hinge", geometry.hinges)):
        start, entry = vertex_entries(elements, vertices)
        setattr(shell, f"{name}_start", wp.array(start, dtype=int, device=device))
        setattr(shell, f"{name}_entry", wp.array(entry, dtype=int, device=device))
    return shell
