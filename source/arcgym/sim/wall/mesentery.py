# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Mesenteries of the colons of all worlds, as sheets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.shell import ShellMesh
from arcgym.anatomy.stage import WallMesh
from arcgym.assets.anchors import way_along_segment
from arcgym.assets.mesentery_cfg import MesenteryCfg
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import mesentery_kernels as kernels
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_readout import WallReadout
from arcgym.sim.wall.wall_topology import ring_mean

MESENTERY = "mesentery."
"""Begins the names of what differs between worlds."""


class Mesentery:
    """Sheets that hold some segments: free to swing about their roots, tight beyond their length. R rings, W worlds."""

    def __init__(
        self,
        cfg: MesenteryCfg,
        meshes: Sequence[WallMesh | ShellMesh],
        members: wp.array,
        patient: wp.array,
        device: str,
    ):
        """Find the roots and allocate.

        Args:
            cfg: Settings.
            meshes: Wall of each patient.
            members: Vertices of each ring, -1 padded, shape (R, S).
            patient: Patient of each world, shape (W,), int32, read in every step.
            device: Warp device.
        """
        self._device, num_envs = device, len(patient)
        heights = [heights_of(cfg, mesh) for mesh in meshes]
        aside = np.array(cfg.root) / np.linalg.norm(cfg.root)
        sheets = self.sheets = kernels.Sheets()
        sheets.patient, sheets.members = patient, members
        roots = [
            ring_mean(mesh.points.astype(np.float64), mesh.ring) + height[:, None] * aside
            for mesh, height in zip(meshes, heights, strict=True)
        ]
        sheets.root = patient_array(roots, wp.vec3, device)
        sheets.height = patient_array(heights, float, device)
        sheets.width = patient_array([np.gradient(mesh.ring_arc) for mesh in meshes], float, device)
        sheets.fullness = wp.full(num_envs, cfg.fullness, dtype=float, device=device)
        sheets.stiffness = wp.full(num_envs, cfg.youngs_modulus * cfg.thickness, dtype=float, device=device)
        sheets.stiffening, sheets.largest_strain = cfg.stiffening, cfg.largest_strain
        self._shape = (len(members), num_envs)

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """What may differ between worlds, shape (W,) each: fullness, and modulus times thickness [N/m]."""
        arrays = {"fullness": self.sheets.fullness, "stiffness": self.sheets.stiffness}
        return {f"{MESENTERY}{name}": wp.to_torch(array) for name, array in arrays.items()}

    def read(self, x: wp.array, tissue: Tissue, readout: WallReadout) -> None:
        """Add the pulls at ``x`` [m], shape (V, W), vec3, to the tensions that the readout measured there."""
        inputs, outputs = [x, self.sheets, tissue.anchor], [readout.tension, readout.tension_peak]
        wp.launch(kernels.read_sheets, self._shape, inputs=inputs, outputs=outputs, device=self._device)

    def stretch(self, centers: torch.Tensor) -> torch.Tensor:
        """Return how much farther from its root each ring is than its sheet is long [m], 0 without one, shape (W, R).

        Args:
            centers: Middles of the rings [m], shape (W, R, 3).
        """
        patient = wp.to_torch(self.sheets.patient).long()
        root = wp.to_torch(self.sheets.root).transpose(0, 1)[patient]
        height = wp.to_torch(self.sheets.height).transpose(0, 1)[patient]
        beyond = torch.linalg.vector_norm(centers - root, dim=2) - height * wp.to_torch(self.sheets.fullness)[:, None]
        return torch.where(height > 0.0, beyond.clamp(min=0.0), 0.0)


def heights_of(cfg: MesenteryCfg, mesh: WallMesh | ShellMesh) -> np.ndarray:
    """Return the height of each ring's sheet [m], 0 without one, shape (R,).

    Args:
        cfg: Settings.
        mesh: The wall.
    """
    largest = np.array([cfg.height.get(name, 0.0) for name in SEGMENTS])[mesh.segment]
    height = np.maximum(largest * np.sin(np.pi * way_along_segment(mesh)), cfg.least_height)
    return ring_mean(np.where(largest > 0.0, height, 0.0), mesh.ring)
