# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shells on the device, with their kernels: plain, and with gas inside."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any

import torch
import warp as wp

from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import (
    gas_shell_kernels,
    shell_cuda_kernels,
    shell_kernels,
    shell_lanes_kernels,
    shell_measure_cuda_kernels,
)
from arcgym.sim.wall.band_kernels import band_kernel
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.shell_fans import ordered_corners, own_hinges, triangle_rest, vertex_triangles
from arcgym.sim.wall.sweep_kernels import sweep_kernels
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_topology import vertex_entries
from arcgym.utils.threaded_graph import in_parts, launch_rows


class Shell:
    """Triangles and hinges, measured once a step."""

    size = 1.0
    memory: dict[str, torch.Tensor] = {}
    _laws = (shell_kernels.ShellElements, shell_kernels.add_elements, shell_kernels.add_forces)
    plain = sweep_kernels(*_laws, on_gpu=shell_cuda_kernels.add_elements)
    surrounded = sweep_kernels(*_laws, surrounded=True, on_gpu=shell_cuda_kernels.add_elements)
    measure_bands = band_kernel(shell_kernels.ShellElements, shell_kernels.add_band_triangle)
    measure_changed_bands = band_kernel(shell_kernels.ShellElements, shell_kernels.add_band_triangle, True)

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
        self.kernels: ModuleType = shell_kernels
        """Module of the kernels that measure."""
        self.in_lanes = wp.get_device(device).is_cpu
        """Whether those of :mod:`.shell_lanes_kernels` do it."""
        if wp.get_device(device).is_cuda:
            self.kernels = shell_measure_cuda_kernels
        first = geometries[0]
        triangles, hinges = first.triangles, first.hinges
        self.corners = triangles
        start, corner = vertex_entries(triangles, vertices)
        if wp.get_device(device).is_cuda:
            corner = ordered_corners(triangles, start, corner)
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

    def advance(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing: these walls remember nothing."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure normals and corner forces of the triangles and angles of the hinges."""
        data, kernels = self.data, self.kernels
        if self.in_lanes:
            self._measure_in_lanes(x, tissue)
            return
        launch_rows(kernels.measure_hinges, data.angle_change.shape, [x], [data], self.device)
        launch_rows(kernels.measure_moments, data.angle_change.shape, [tissue], [data], self.device)
        launch_rows(kernels.measure_triangles, data.scaled_normal.shape, [x, tissue], [data], self.device)

    def _measure_in_lanes(self, x: wp.array, tissue: Tissue) -> None:
        for kernel, out in (
            (shell_lanes_kernels.measure_hinges, self.data.angle_change),
            (shell_lanes_kernels.measure_moments, self.data.moment),
            (shell_lanes_kernels.measure_triangles, self.data.scaled_normal),
        ):
            count, worlds = out.shape

            def launch(first: int, rows: int, kernel: wp.Kernel = kernel, worlds: int = worlds) -> None:
                blocks, inputs = -(-rows // shell_lanes_kernels.LANES), [first, rows, x, tissue]
                shape = (blocks, worlds)
                wp.launch(kernel, shape, inputs=inputs, outputs=[self.data], device=self.device)

            in_parts(count, launch)


class GasShell:
    """Triangles and hinges with gas inside, measured once a step."""

    size = Shell.size
    memory: dict[str, torch.Tensor] = {}
    _laws = (gas_shell_kernels.GasShellElements, gas_shell_kernels.add_gas_elements, gas_shell_kernels.add_gas_forces)
    plain = sweep_kernels(*_laws)
    surrounded = sweep_kernels(*_laws, surrounded=True)
    measure_bands = band_kernel(gas_shell_kernels.GasShellElements, gas_shell_kernels.add_gas_band_triangle)
    measure_changed_bands = None

    def __init__(
        self, geometries: Sequence[ShellGeometry], vertices: int, patient: wp.array, device: str, gas: GasLoads
    ):
        """Build the shell, see :class:`Shell`; ``gas`` is read in every step."""
        self._shell = Shell(geometries, vertices, patient, device)
        self.corners = self._shell.corners
        self.data = gas_shell_kernels.GasShellElements()
        self.data.shell, self.data.gas = self._shell.data, gas

    def advance(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing: these walls remember nothing."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the shell, and add the gas to its corner forces."""
        shell = self._shell
        shell.measure(x, tissue)
        shape = shell.data.scaled_normal.shape
        wp.launch(gas_shell_kernels.add_gas, shape, inputs=[x, self.data], device=shell.device)
