# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Walls of patients as numbers, in numpy, and as Warp structs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp

from arcgym.assets.anchors import AnchorSprings
from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall.anchor_kernels import Anchors
from arcgym.sim.wall.wall_kernels import WallNodes


@dataclass(frozen=True)
class SolidParameters:
    """Tetrahedral wall of T tets."""

    tets: np.ndarray
    """Vertex indices, shape (T, 4)."""


@dataclass(frozen=True)
class ShellParameters:
    """Shell of triangles and hinges."""

    geometry: ShellGeometry
    """Rest geometry."""


@dataclass(frozen=True)
class WallParameters:
    """One patient's wall, V vertices."""

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
    share: np.ndarray
    """Thickness of each ring over that of the tissue, shape (R,); 1 but for walls whose thickness differs."""
    colors: list[np.ndarray]
    """Vertices that share no element, color by color."""


def wall_nodes(walls: Sequence[WallParameters], patient: wp.array, device: str) -> WallNodes:
    """Copy the vertices of all patients to the device; ``patient`` is that of each world, shape (W,), int32."""
    nodes = WallNodes()
    nodes.patient = patient
    nodes.mass = patient_array([wall.mass for wall in walls], float, device)
    nodes.mobile = patient_array([wall.mobile.astype(np.int32) for wall in walls], int, device)
    nodes.anchors = wall_anchors([wall.points for wall in walls], [wall.anchor for wall in walls], patient, device)
    return nodes


def wall_anchors(
    points: Sequence[np.ndarray], springs: Sequence[AnchorSprings], patient: wp.array, device: str
) -> Anchors:
    """Copy the anchor springs of all patients to the device.

    Args:
        points: Rest positions of each patient [m], shape (V, 3).
        springs: Springs of each patient.
        patient: Patient of each world, shape (W,), int32.
        device: Warp device.
    """
    anchors = Anchors()
    anchors.patient = patient
    for name in ("stiffness", "loose", "slack"):
        setattr(anchors, name, patient_array([getattr(spring, name) for spring in springs], float, device))
    anchors.rest = patient_array(points, wp.vec3, device)
    return anchors
