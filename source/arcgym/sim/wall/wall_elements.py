# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Elements of a wall on the device, with their kernels."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import warp as wp

from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim.wall import shell_kernels, solid_kernels
from arcgym.sim.wall.shell_fans import own_hinges, triangle_rest, vertex_triangles
from arcgym.sim.wall.sweep_kernels import sweep_kernels
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_parameters import ShellParameters, WallParameters
from arcgym.sim.wall.wall_topology import vertex_entries


class WallElements(Protocol):
    """Elements of all worlds' walls."""

    sweep_color: wp.Kernel
    """Sweep over this kind of elements, see :mod:`arcgym.sim.wall.sweep_kernels`."""
    residual: wp.Kernel
    """Total force with this kind of elements."""
    data: Any
    """Struct that those kernels take."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the elements at positions ``x`` [m], shape (V, W), before a residual or a sweep."""


def wall_elements(wall: WallParameters, num_envs: int, device: str) -> WallElements:
    """Return elements of the wall's kind for ``num_envs`` worlds."""
    if isinstance(wall.elements, ShellParameters):
        return Shell(wall.elements.geometry, len(wall.points), num_envs, device)
    return Solid(wall.points, wall.elements.tets, device)


class Solid:
    """Tetrahedra, which need nothing measured."""

    sweep_color, residual = sweep_kernels(
        solid_kernels.SolidElements, solid_kernels.add_elastic, solid_kernels.add_elastic
    )

    def __init__(self, points: np.ndarray, tets: np.ndarray, device: str):
        """Copy the T tets of one world's V vertices to the device.

        Args:
            points: Rest positions [m], shape (V, 3).
            tets: Vertices of each, shape (T, 4).
            device: Warp device.
        """
        edges = (points[tets[:, 1:]] - points[tets[:, :1]]).transpose(0, 2, 1)
        start, entry = vertex_entries(tets, len(points))
        self.data = solid_kernels.SolidElements()
        self.data.tets = wp.array(tets, dtype=wp.vec4i, device=device)
        self.data.inv_rest = wp.array(np.linalg.inv(edges), dtype=wp.mat33, device=device)
        self.data.volume = wp.array(np.linalg.det(edges) / 6.0, dtype=float, device=device)
        self.data.entry_start = wp.array(start, dtype=int, device=device)
        self.data.entry = wp.array(entry, dtype=int, device=device)

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing."""


class Shell:
    """Triangles and hinges, measured once a step."""

    sweep_color, residual = sweep_kernels(
        shell_kernels.ShellElements, shell_kernels.add_elements, shell_kernels.add_forces
    )

    def __init__(self, geometry: ShellGeometry, vertices: int, num_envs: int, device: str):
        """Copy the elements of one world's wall to the device and allocate what is measured in all W worlds.

        Args:
            geometry: Rest geometry of F triangles and H hinges.
            vertices: Number of vertices, V.
            num_envs: Worlds, W.
            device: Warp device.
        """
        self.device, self.num_envs = device, num_envs
        vertex_triangle: Any = shell_kernels.VertexTriangle
        self.data = data = shell_kernels.ShellElements()
        triangles, hinges = geometry.triangles, geometry.hinges
        start, corner = vertex_entries(triangles, vertices)
        copies = {
            "triangles": (triangles, wp.vec3i),
            "rest": (triangle_rest(geometry), wp.vec4),
            "edges": (own_hinges(geometry), wp.vec3i),
            "hinges": (hinges, wp.vec4i),
            "rest_angle": (geometry.rest_angle, float),
            "coupled": (geometry.coupled, int),
            "coupling": (geometry.coupling, wp.vec2),
            "inverse_length": (1.0 / geometry.length, float),
            "fan_start": (start, int),
            "fan": (vertex_triangles(geometry, corner, vertex_triangle.numpy_dtype()), vertex_triangle),
            "fan_corner": (corner, int),
        }
        for name, (values, dtype) in copies.items():
            setattr(data, name, wp.array(values, dtype=dtype, device=device))
        data.scaled_normal = wp.zeros((len(triangles), num_envs), dtype=wp.vec3, device=device)
        data.corner_force = wp.zeros((3 * len(triangles), num_envs), dtype=wp.vec3, device=device)
        data.angle_change = wp.zeros((len(hinges), num_envs), dtype=float, device=device)
        data.moment = wp.zeros((len(hinges), num_envs), dtype=float, device=device)

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure normals and corner forces of the triangles and angles of the hinges."""
        data = self.data
        shape = data.angle_change.shape
        wp.launch(shell_kernels.measure_hinges, shape, inputs=[x], outputs=[data], device=self.device)
        wp.launch(shell_kernels.measure_moments, shape, inputs=[tissue], outputs=[data], device=self.device)
        shape = data.scaled_normal.shape
        wp.launch(shell_kernels.measure_triangles, shape, inputs=[x, tissue], outputs=[data], device=self.device)
