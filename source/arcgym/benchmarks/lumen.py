# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Links that have left the lumen: the wall let them through."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import warp as wp

from arcgym.anatomy.measures import inner_faces
from arcgym.benchmarks.lumen_kernels import winding_number

MARGIN = 4
"""Rings at either end of the colon whose links are left out: there the surface is open, or the scope outside it."""


class LumenCheck:
    """Counts links outside the lumen, on the device. N worlds, L links, V wall vertices."""

    def __init__(self, sim: Any) -> None:
        """Take the inner surface of a simulation's colon."""
        self._sim = sim
        triangles = np.ascontiguousarray(lumen_triangles(sim.colon.wall), dtype=np.int32)
        self._triangles = wp.array(triangles, dtype=wp.vec3i, device=sim.device)
        self._winding = wp.zeros((sim.num_envs, sim.endoscope.num_bodies), dtype=float, device=sim.device)

    def outside(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Return links outside the lumen and links examined, bool, shape (N, L).

        A link is outside if the inner surface winds around its centre by less than half.
        """
        colon, endoscope = self._sim.colon, self._sim.endoscope
        points = wp.from_torch(colon.data.nodal_pos_w.contiguous(), dtype=wp.vec3)
        centers = wp.from_torch(endoscope.data.body_pos_w.contiguous(), dtype=wp.vec3)
        inputs = [points, self._triangles, centers]
        wp.launch(winding_number, self._winding.shape, inputs, [self._winding], device=self._sim.device)
        ring = self._sim.world_arrays()["link_ring"]
        examined = (ring >= MARGIN) & (ring < colon.num_rings - MARGIN)
        return examined & (wp.to_torch(self._winding).abs() < 0.5), examined


def lumen_triangles(wall: Any) -> np.ndarray:
    """Return the triangles of the simulated wall's inner surface, or of a shell, shape (F, 3)."""
    triangles = getattr(wall, "triangles", None)
    return inner_faces(wall.tets, wall.layer) if triangles is None else triangles
