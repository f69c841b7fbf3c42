# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shell whose tissue has a law of its own, on the device."""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
import warp as wp

from arcgym.assets.shell_geometry import ShellGeometry
from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import shell_kernels
from arcgym.sim.wall import tissue_shell_kernels as kernels
from arcgym.sim.wall.band_kernels import band_kernel
from arcgym.sim.wall.cell_strain import cell_partners, partner_edges
from arcgym.sim.wall.cell_strain_kernels import Cells
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.shell_elements import Shell
from arcgym.sim.wall.shell_kernels import STIFFENING
from arcgym.sim.wall.sweep_kernels import sweep_kernels
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_parameters import ShellParameters, WallParameters
from arcgym.utils.threaded_graph import launch_rows

RELAXATION = "relaxation."
"""Begins the names of the wall's memory of its tension. A state without them is that of a wall that has rested."""


class TissueShell:
    """Triangles and hinges with stiffening, thickness and relaxation of their own, and gas inside if there is any."""

    size = Shell.size
    _laws = (kernels.TissueShellElements, kernels.add_tissue_elements, kernels.add_tissue_forces)
    plain = sweep_kernels(*_laws)
    surrounded = sweep_kernels(*_laws, surrounded=True)
    measure_bands = band_kernel(kernels.TissueShellElements, kernels.add_tissue_band_triangle)
    measure_changed_bands = None

    def __init__(
        self,
        law: WallLawCfg,
        walls: Sequence[WallParameters],
        dt: float,
        patient: wp.array,
        device: str,
        gas: GasLoads | None,
    ):
        """Build the shell, see :class:`Shell`.

        Args:
            law: Settings.
            walls: Wall of each patient.
            dt: Physics step [s].
            patient: Patient of each world, shape (W,), int32.
            device: Warp device.
            gas: What gas does to the walls, read in every step; None for none.
        """
        geometries = [wall.elements.geometry for wall in walls if isinstance(wall.elements, ShellParameters)]
        self._shell = Shell(geometries, len(walls[0].points), patient, device)
        self.corners = self._shell.corners
        self.data = kernels.TissueShellElements()
        self.data.shell = self._shell.data
        self.data.gassy, self.data.relaxing = int(gas is not None), int(law.relaxation)
        if gas is not None:
            self.data.gas = gas
        self.data.stiffening = float(STIFFENING) if law.stiffening is None else law.stiffening
        shares = [wall.share[wall.ring][self.corners].mean(axis=1) for wall in walls]
        self.data.share = patient_array(shares, float, device)
        shape = (len(self.corners), len(patient)) if law.relaxation else (0, 0)
        self._memory = memory = kernels.Memory()
        memory.quick, memory.slow, self.data.relief = (wp.zeros(shape, dtype=wp.vec3, device=device) for _ in range(3))
        self.data.cells = self._cells(law, walls, geometries, patient, device)
        memory.shares = wp.vec2(*law.relaxing_share)
        memory.ways = wp.vec2(*(1.0 - math.exp(-dt / time) for time in law.relaxing_time))
        self._start: wp.array | None = None

    def _cells(
        self,
        law: WallLawCfg,
        walls: Sequence[WallParameters],
        geometries: Sequence[ShellGeometry],
        patient: wp.array,
        device: str,
    ) -> Cells:
        cells = Cells()
        cells.enabled = int(law.cell_strain)
        if not law.cell_strain:
            return cells
        partner = cell_partners(geometries[0], walls[0].ring)
        cells.partner = wp.array(partner, dtype=int, device=device)
        weights = [one.area[partner] / (one.area + one.area[partner]) for one in geometries]
        edges = [partner_edges(one, wall.points, partner) for one, wall in zip(geometries, walls, strict=True)]
        cells.weight, cells.edges = patient_array(weights, float, device), patient_array(edges, wp.mat33, device)
        cells.excess = wp.zeros((len(partner), len(patient)), dtype=wp.vec3, device=device)
        return cells

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What the wall remembers of its tension [N/m], by name, as views of shape (W, F, 3)."""
        if self.data.relaxing == 0:
            return {}
        arrays = {"quick": self._memory.quick, "slow": self._memory.slow}
        return {f"{RELAXATION}{name}": wp.to_torch(array).transpose(0, 1) for name, array in arrays.items()}

    def advance(self, x: wp.array, tissue: Tissue) -> None:
        """Begin a step at positions ``x`` [m], shape (V, W): the next :meth:`measure` lets the tension fade there."""
        self._start = x if self.data.relaxing == 1 else None

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the shell with its tissue and its gas."""
        shell = self._shell.data
        device, hinges, triangles = self._shell.device, shell.angle_change.shape, shell.scaled_normal.shape
        launch_rows(shell_kernels.measure_hinges, hinges, [x], [shell], device)
        launch_rows(shell_kernels.measure_moments, hinges, [tissue], [shell], device)
        if self._start is None:
            launch_rows(kernels.measure_tissue, triangles, [x, tissue], [self.data], device)
            return
        launch_rows(kernels.relax_and_measure, triangles, [self._start, x, tissue], [self.data, self._memory], device)
        self._start = None
