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
from arcgym.utils.math import quat_apply

MARGIN = 4
"""Rings at either end of the colon whose links are left out: there the surface is open, or the scope outside it."""
OPENING = 0.04
"""Distance from the axis of the anus within which a link below these rings is beyond the open end, whatever ring it is
held to be in, and more by as much as it is lower [m]: a link that is pulled out of tissue in which it was bent may keep
a ring of the sigmoid."""
CORE = 0.5
"""Share of its radius by which a link must be inside: its surface dents into the wall where the two touch."""
ALONG = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Places along a link's axis, as shares of half its length."""
AROUND = 4
"""Points around each of them."""


class LumenCheck:
    """Counts links outside the lumen, on the device. N worlds, L links, V wall vertices."""

    def __init__(self, sim: Any) -> None:
        """Take the inner surface of a simulation's colon."""
        self._sim = sim
        triangles = np.ascontiguousarray(lumen_triangles(sim.colon.wall), dtype=np.int32)
        self._triangles = wp.array(triangles, dtype=wp.vec3i, device=sim.device)
        points = core_points(sim.endoscope.half_length, sim.endoscope.stage.link_radius)
        self._points = torch.tensor(points, dtype=torch.float, device=sim.device)
        self._winding = wp.zeros((sim.num_envs, points.shape[0] * points.shape[1]), dtype=float, device=sim.device)

    def outside(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Return links outside the lumen and links examined, bool, shape (N, L).

        A link is outside if the inner surface winds by less than half around any point of its core, see
        :func:`core_points`.
        """
        colon, data = self._sim.colon, self._sim.endoscope.data
        wall = wp.from_torch(colon.data.nodal_pos_w.contiguous(), dtype=wp.vec3)
        points = data.body_pos_w[:, :, None] + quat_apply(data.body_quat_w[:, :, None], self._points)
        points = wp.from_torch(points.flatten(1, 2).contiguous(), dtype=wp.vec3)
        inputs = [wall, self._triangles, points]
        wp.launch(winding_number, self._winding.shape, inputs, [self._winding], device=self._sim.device)
        ring = self._sim.world_arrays()["link_ring"]
        examined = (ring >= MARGIN) & (ring < colon.num_rings - MARGIN) & ~self._at_opening(data.body_pos_w)
        inside = wp.to_torch(self._winding).view(*ring.shape, -1).abs() >= 0.5
        return examined & ~inside.all(dim=2), examined

    def _at_opening(self, places: torch.Tensor) -> torch.Tensor:
        """Return which places, shape (N, L, 3), are below the rings left out at the anus and near its axis, (N, L)."""
        centers = wp.to_torch(self._sim.contact.centers)
        return below_opening(places, centers[:, 0], centers[:, MARGIN])


def below_opening(places: torch.Tensor, first: torch.Tensor, last: torch.Tensor) -> torch.Tensor:
    """Return which places lie before the last of the rings left out, in a cone about the line from it to the first.

    Args:
        places: Centers of links [m], shape (N, L, 3).
        first: Center of the colon's first ring [m], shape (N, 3).
        last: Center of the first ring whose links are examined [m], shape (N, 3).
    """
    axis = torch.nn.functional.normalize(last - first, dim=1)[:, None]
    along = ((places - last[:, None]) * axis).sum(dim=2)
    across = places - last[:, None] - along[:, :, None] * axis
    return across.norm(dim=2) < torch.where(along < 0.0, OPENING - along, 0.0)


def core_points(half_length: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Return points of links' cores in their frames [m], shape (L, P, 3).

    On the axis from end to end, and half the radius away from it to four sides.

    Args:
        half_length: Half the length of each link's axis [m], shape (L,).
        radius: Radius of each link [m], shape (L,).
    """
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    across = np.r_[np.zeros((1, 2)), CORE * np.stack([np.cos(angle), np.sin(angle)], axis=1)]
    points = np.zeros((len(radius), len(ALONG), len(across), 3))
    points[..., :2] = np.asarray(radius)[:, None, None, None] * across
    points[..., 2] = (np.asarray(half_length)[:, None] * np.array(ALONG))[:, :, None]
    return points.reshape(len(radius), -1, 3)


def lumen_triangles(wall: Any) -> np.ndarray:
    """Return the triangles of the simulated wall's inner surface, or of a shell, shape (F, 3)."""
    triangles = getattr(wall, "triangles", None)
    return inner_faces(wall.tets, wall.layer) if triangles is None else triangles
