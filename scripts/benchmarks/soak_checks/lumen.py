# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Links that have left the lumen: the wall let them through."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import warp as wp

from soak_checks.lumen_kernels import winding_number

MARGIN = 4
"""Rings at either end of the colon whose links are left out: there the surface is open, or the scope outside it."""


class LumenCheck:
    """Counts links outside the lumen, on the device. N worlds, L links, V wall vertices."""

    def __init__(self, env: Any) -> None:
        """Takes the inner surface of the environment's colon."""
        self._env = env
        triangles = np.ascontiguousarray(lumen_triangles(env.scene["colon"]), dtype=np.int32)
        self._triangles = wp.array(triangles, dtype=wp.vec3i, device=env.device)
        shape = (env.num_envs, env.scene["endoscope"].num_bodies)
        self._winding = wp.zeros(shape, dtype=float, device=env.device)

    def outside(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Links outside the lumen and links examined, bool, shape (N, L).

        A link is outside if the inner surface winds around its centre by less than half.
        """
        colon, endoscope = self._env.scene["colon"], self._env.scene["endoscope"]
        points = wp.from_torch(colon.data.nodal_pos_w.contiguous(), dtype=wp.vec3)
        centers = wp.from_torch(endoscope.data.body_pos_w.contiguous(), dtype=wp.vec3)
        args = [points, self._triangles, centers, self._winding]
        wp.launch(winding_number, self._winding.shape, args, device=self._env.device)
        ring = self._env.sim.world_arrays()["link_ring"]
        examined = (ring >= MARGIN) & (ring < colon.num_rings - MARGIN)
        return examined & (wp.to_torch(self._winding).abs() < 0.5), examined


def lumen_triangles(colon: Any) -> np.ndarray:
    """Triangles of the simulated wall's inner surface, or of a shell, shape (F, 3)."""
    from arcgym.anatomy.measures import inner_faces

    wall = getattr(colon, "wall", None) or colon.stage.wall
    triangles = getattr(wall, "triangles", None)
    return inner_faces(wall.tets, wall.layer) if triangles is None else triangles
