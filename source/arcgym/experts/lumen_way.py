# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The way that is open ahead of the tip, along the wall as it is now. N worlds."""

from __future__ import annotations

import torch
import warp as wp

from arcgym.experts import lumen_way_kernels as kernels
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import norm, points_at, row_cumsum

REACH = 0.08
"""Length of centerline ahead of the tip along which the way is laid [m]."""
STEP = 0.005
"""Distance of its points along the centerline [m]."""
CLEARANCE = 0.011
"""Distance that it keeps from the wall where there is room [m]: a head's radius of 6.6 mm and half the wall."""
SWEEPS = 24
"""Sweeps that pull it taut; an even number."""
BEHIND = 3
"""Rings behind the tip's whose faces count."""
AHEAD = 3
"""Rings beyond the way's end whose faces count."""


class LumenWay:
    """A band from the tip along the centerline ahead, pulled taut and kept off the deformed wall.

    A point of the centerline some way ahead may lie behind a fold. The band goes around the fold, so that what is
    aimed at along it can be reached.
    """

    def __init__(self, scene: InteractiveScene):
        """Allocate the band.

        Args:
            scene: The scene; its state is read anew at every :meth:`find`.
        """
        self.scene = scene
        count = round(REACH / STEP)
        self._ahead_arc = STEP * torch.arange(1, count + 1, device=scene.device)
        shape = (scene.num_envs, count)
        self._bands = [wp.zeros(shape, dtype=wp.vec3, device=scene.device) for _ in range(2)]
        self._room = wp.zeros(shape, dtype=float, device=scene.device)
        self._tip = wp.zeros(scene.num_envs, dtype=wp.vec3, device=scene.device)
        self._ring = wp.zeros(scene.num_envs, dtype=int, device=scene.device)
        self._last_ring = wp.zeros_like(self._ring)

    def find(self) -> torch.Tensor:
        """Return the way ahead of every tip, its first point the tip's front [m], shape (N, K + 1, 3)."""
        data, colon, sim = self.scene["endoscope"].data, self.scene["colon"].data, self.scene.sim
        arc = data.tip_arc_length[:, None]
        start = points_at(colon.centerline_pos_w, colon.centerline_arc, arc + self._ahead_arc)
        wp.to_torch(self._bands[0]).copy_(start)
        wp.to_torch(self._tip).copy_(data.tip_pos_w)
        wp.to_torch(self._ring).copy_(torch.searchsorted(colon.centerline_arc, arc.contiguous())[:, 0])
        wp.to_torch(self._last_ring).copy_(torch.searchsorted(colon.centerline_arc, arc + REACH)[:, 0] + AHEAD)
        carried = sim.contact.carried
        points = sim.nodal_pos if carried is None else carried.update(sim.nodal_pos)
        wall = [points, sim.contact.surface, self._ring, BEHIND, self._last_ring]
        self._launch(kernels.measure_room, [self._bands[0], *wall, CLEARANCE], [self._room])
        for sweep in range(SWEEPS):
            now, then = self._bands[sweep % 2], self._bands[1 - sweep % 2]
            self._launch(kernels.pull_taut, [now, self._tip, *wall, self._room], [then])
        return torch.cat([data.tip_pos_w[:, None], wp.to_torch(self._bands[0])], dim=1)

    def _launch(self, kernel: wp.Kernel, inputs: list[object], outputs: list[object]) -> None:
        wp.launch(kernel, self._room.shape, inputs=inputs, outputs=outputs, device=self.scene.device)


def along(way: torch.Tensor, look: torch.Tensor) -> torch.Tensor:
    """Return the points at some length of ways, clamped to their ends.

    Args:
        way: Points of each way [m], shape (N, K, 3).
        look: Length from the first point [m], shape (N,).

    Returns:
        Points [m], shape (N, 3).
    """
    gap = norm(way[:, 1:] - way[:, :-1]).clamp(min=1.0e-6)
    length = torch.cat([torch.zeros_like(gap[:, :1]), row_cumsum(gap)], dim=1)
    return points_at(way, length, look[:, None])[:, 0]
