# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Elements of a wall on the device, with their kernels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import warp as wp

from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import gas_shell_kernels, shell_kernels, solid_kernels
from arcgym.sim.wall.band_kernels import band_kernel
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.shell_fans import own_hinges, triangle_rest, vertex_triangles
from arcgym.sim.wall.sweep_kernels import sweep_kernels
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_parameters import ShellParameters, SolidParameters, WallParameters
from arcgym.sim.wall.wall_topology import vertex_entries


class WallElements(Protocol):
    """Elements of all worlds' walls."""

    sweep_color: wp.Kernel
    """Sweep over this kind of elements, see :mod:`arcgym.sim.wall.sweep_kernels`."""
    residual: wp.Kernel
    """Total force with this kind of elements."""
    measure_bands: wp.Kernel
    """Stiffness in the rings' modes, see :mod:`arcgym.sim.wall.band_kernels`."""
    corners: np.ndarray
    """Vertices of each element, shape (E, n)."""
    data: Any
    """Struct that those kernels take."""
    size: float
    """Length that makes the first modulus a stiffness [m]; 1 for a shell, whose moduli are stiffnesses."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the elements at positions ``x`` [m], shape (V, W), before a residual or a sweep."""


def wall_elements(
    walls: Sequence[WallParameters], patient: wp.array, device: str, gas: GasLoads | None = None
) -> WallElements:
    """Return elements of the walls' kind.

    Args:
        walls: Wall of each patient.
        patient: Patient of each world, shape (W,), int32.
        device: Warp device.
        gas: What gas does to the walls, which are shells then; None for none.
    """
    shells = [wall.elements.geometry for wall in walls if isinstance(wall.elements, ShellParameters)]
    if shells and gas is not None:
        return GasShell(shells, len(walls[0].points), patient, device, gas)
    if shells:
        return Shell(shells, len(walls[0].points), patient, device)
    tets = next(wall.elements.tets for wall in walls if isinstance(wall.elements, SolidParameters))
    return Solid([wall.points for wall in walls], tets, patient, device)


class Solid:
    """Tetrahedra, which need nothing measured."""

    sweep_color, residual = sweep_kernels(
        solid_kernels.SolidElements, solid_kernels.add_elastic, solid_kernels.add_elastic
    )
    measure_bands = band_kernel(solid_kernels.SolidElements, solid_kernels.add_band_tet)

    def __init__(self, points: Sequence[np.ndarray], tets: np.ndarray, patient: wp.array, device: str):
        """Copy the T tets of the walls to the device.

        Args:
            points: Rest positions of each patient [m], shape (V, 3).
            tets: Vertices of each, the same for all patients, shape (T, 4).
            patient: Patient of each world, shape (W,), int32.
            device: Warp device.
        """
        edges = [(rest[tets[:, 1:]] - rest[tets[:, :1]]).transpose(0, 2, 1) for rest in points]
        start, entry = vertex_entries(tets, len(points[0]))
        volume = [np.linalg.det(one) / 6.0 for one in edges]
        self.size = float(np.mean(volume)) ** (1.0 / 3.0)
        self.corners = tets
        self.data = solid_kernels.SolidElements()
        self.data.patient = patient
        self.data.tets = wp.array(tets, dtype=wp.vec4i, device=device)
        self.data.inv_rest = patient_array([np.linalg.inv(one) for one in edges], wp.mat33, device)
        self.data.volume = patient_array(volume, float, device)
        self.data.entry_start = wp.array(start, dtype=int, device=device)
        self.data.entry = wp.array(entry, dtype=int, device=device)

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing."""


class Shell:
    """Triangles and hinges, measured once a step."""

    size = 1.0
    sweep_color, residual = sweep_kernels(
        shell_kernels.ShellElements, shell_kernels.add_elements, shell_kernels.add_forces
    )
    measure_bands = band_kernel(shell_kernels.ShellElements, shell_kernels.add_band_triangle)

    def __init__(self, geometries: Sequence[ShellGeometry], vertices: int, patient: wp.array, device: str):
        """Copy the elements of the walls to the device and allocate what is measured in all W worlds.

        Args:
            geometries: Rest geometry of F triangles and H hinges, the same ones in each patient.
            vertices: Number of vertices, V.
            patient: Patient of each world, shape (W,), int32.
            device: Warp device.
        """
        self.device, num_envs = device, len(patient)
        self.data = data = shell_kernels.ShellElements()
        first = geometries[0]
        triangles, hinges = first.triangles, first.hinges
        self.corners = triangles
        start, corner = vertex_entries(triangles, vertices)
        types: Any = (shell_kernels.VertexTriangle, shell_kernels.VertexTriangleRest)
        dtypes = (types[0].numpy_dtype(), types[1].numpy_dtype())
        fans = [vertex_triangles(geometry, corner, dtypes) for geometry in geometries]
        shared = {
            "triangles": (triangles, wp.vec3i),
            "edges": (own_hinges(first), wp.vec3i),
            "hinges": (hinges, wp.vec4i),
            "coupled": (first.coupled, int),
            "fan_start": (start, int),
            "fan": (fans[0][0], types[0]),
            "fan_corner": (corner, int),
        }
        own = {
            "rest": ([triangle_rest(geometry) for geometry in geometries], wp.vec4),
            "rest_angle": ([geometry.rest_angle for geometry in geometries], float),
            "coupling": ([geometry.coupling for geometry in geometries], wp.vec2),
            "inverse_length": ([1.0 / geometry.length for geometry in geometries], float),
            "fan_rest": ([fan[1] for fan in fans], types[1]),
        }
        data.patient = patient
        for name, (array, dtype) in shared.items():
            setattr(data, name, wp.array(array, dtype=dtype, device=device))
        for name, (arrays, dtype) in own.items():
            setattr(data, name, patient_array(arrays, dtype, device))
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


class GasShell:
    """Triangles and hinges with gas inside, measured once a step."""

    size = Shell.size
    sweep_color, residual = sweep_kernels(
        gas_shell_kernels.GasShellElements, gas_shell_kernels.add_gas_elements, gas_shell_kernels.add_gas_forces
    )
    measure_bands = band_kernel(gas_shell_kernels.GasShellElements, gas_shell_kernels.add_gas_band_triangle)

    def __init__(
        self, geometries: Sequence[ShellGeometry], vertices: int, patient: wp.array, device: str, gas: GasLoads
    ):
        """Build the shell, see :class:`Shell`; ``gas`` is read in every step."""
        self._shell = Shell(geometries, vertices, patient, device)
        self.corners = self._shell.corners
        self.data = gas_shell_kernels.GasShellElements()
        self.data.shell, self.data.gas = self._shell.data, gas

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the shell, and add the gas to its corner forces."""
        shell = self._shell
        shell.measure(x, tissue)
        shape = shell.data.scaled_normal.shape
        wp.launch(gas_shell_kernels.add_gas, shape, inputs=[x, self.data], device=shell.device)
