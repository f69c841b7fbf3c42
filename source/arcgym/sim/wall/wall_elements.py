# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Elements of a wall on the device, with their kernels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import torch
import warp as wp

from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import solid_kernels
from arcgym.sim.wall.band_kernels import band_kernel
from arcgym.sim.wall.gas_kernels import GasLoads
from arcgym.sim.wall.shell_elements import GasShell, Shell
from arcgym.sim.wall.sweep_kernels import SweepKernels, sweep_kernels
from arcgym.sim.wall.tissue_shell import TissueShell
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_parameters import ShellParameters, SolidParameters, WallParameters
from arcgym.sim.wall.wall_topology import vertex_entries


class WallElements(Protocol):
    """Elements of all worlds' walls."""

    plain: SweepKernels
    """Sweep over this kind of elements, and their total force, see :mod:`arcgym.sim.wall.sweep_kernels`."""
    surrounded: SweepKernels
    """The same for walls with surroundings, see :mod:`arcgym.sim.wall.outer_force_kernels`."""
    measure_bands: wp.Kernel
    """Stiffness in the rings' modes, see :mod:`arcgym.sim.wall.band_kernels`."""
    measure_changed_bands: wp.Kernel | None
    """The same where a ring has changed, for a GPU; None where the stiffness depends on more than the wall's places and
    its moduli."""
    corners: np.ndarray
    """Vertices of each element, shape (E, n)."""
    data: Any
    """Struct that those kernels take."""

    @property
    def size(self) -> float | np.ndarray:
        """Length that makes the first modulus a stiffness [m], (P,); 1 for shells, whose moduli are stiffnesses."""

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What the elements' future depends on besides the wall, by name, as views of shape (W, ...)."""

    def advance(self, x: wp.array, tissue: Tissue) -> None:
        """Begin a step at positions ``x`` [m], shape (V, W)."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Measure the elements at positions ``x`` [m], shape (V, W), before a residual or a sweep."""


def wall_elements(
    walls: Sequence[WallParameters],
    patient: wp.array,
    dt: float,
    device: str,
    gas: GasLoads | None = None,
    law: WallLawCfg | None = None,
) -> WallElements:
    """Return elements of the walls' kind.

    Args:
        walls: Wall of each patient.
        patient: Patient of each world, shape (W,), int32.
        dt: Physics step [s].
        device: Warp device.
        gas: What gas does to the walls, which are shells then; None for none.
        law: How the walls stretch, which are shells then; None for the plain law.
    """
    shells = [wall.elements.geometry for wall in walls if isinstance(wall.elements, ShellParameters)]
    if law is not None:
        return TissueShell(law, walls, dt, patient, device, gas)
    if shells and gas is not None:
        return GasShell(shells, len(walls[0].points), patient, device, gas)
    if shells:
        return Shell(shells, len(walls[0].points), patient, device)
    tets = next(wall.elements.tets for wall in walls if isinstance(wall.elements, SolidParameters))
    return Solid([wall.points for wall in walls], tets, patient, device)


class Solid:
    """Tetrahedra, which need nothing measured and remember nothing."""

    memory: dict[str, torch.Tensor] = {}
    _laws = (solid_kernels.SolidElements, solid_kernels.add_elastic, solid_kernels.add_elastic)
    plain = sweep_kernels(*_laws)
    surrounded = sweep_kernels(*_laws, surrounded=True)
    measure_bands = band_kernel(solid_kernels.SolidElements, solid_kernels.add_band_tet)
    measure_changed_bands = None

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
        self.size = np.array([float(np.mean(one)) ** (1.0 / 3.0) for one in volume])
        self.corners = tets
        self.data = solid_kernels.SolidElements()
        self.data.patient = patient
        self.data.tets = wp.array(tets, dtype=wp.vec4i, device=device)
        self.data.inv_rest = patient_array([np.linalg.inv(one) for one in edges], wp.mat33, device)
        self.data.volume = patient_array(volume, float, device)
        self.data.entry_start = wp.array(start, dtype=int, device=device)
        self.data.entry = wp.array(entry, dtype=int, device=device)

    def advance(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing."""

    def measure(self, x: wp.array, tissue: Tissue) -> None:
        """Do nothing."""
