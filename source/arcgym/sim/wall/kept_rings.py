# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a GPU keeps of the ring equations where the wall hardly moves."""

from __future__ import annotations

import warp as wp

from arcgym.sim.contact.contact_kernels import ContactRecords
from arcgym.sim.contact.self_contact_kernels import SelfContactForce
from arcgym.sim.wall import kept_ring_kernels as kernels
from arcgym.sim.wall.band_kernels import RingAxes, Rings
from arcgym.sim.wall.coarse_kernels import RingLoads
from arcgym.sim.wall.kept_rows_kernels import KeptRows
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils.warp_setup import GPU_BLOCK

UNMOVED = 6.0e-5
"""How far a vertex may move until the stiffness around its ring is measured again [m]: six thousandths of an edge.
The residual, which decides where the wall goes, is always that of its present shape; the way there is off by as much,
of moves that are shorter than this."""


class KeptRings:
    """Rings whose stiffness is kept, and rows of their equations whose factors are. Most of a colon is at rest."""

    def __init__(self, vertices: int, rings: int, num_envs: int, device: str):
        """Know nothing yet of the ``num_envs`` walls, of so many vertices and rings."""
        self._shape, self._device = (rings, num_envs), device
        self.rings = kernels.KeptRingState()
        """The rings."""
        self.rings.place = wp.zeros((vertices, num_envs), dtype=wp.vec3, device=device)
        self.rings.tissue = wp.full(self._shape, -1.0, dtype=wp.vec4, device=device)
        self.rings.changed = wp.ones(self._shape, dtype=int, device=device)
        self.rows = KeptRows()
        """The rows."""
        self.rows.first = wp.full(num_envs, rings, dtype=int, device=device)
        self.rows.middle = wp.full(num_envs, -1, dtype=int, device=device)
        self.rows.touched = wp.ones(self._shape, dtype=int, device=device)

    def place(
        self, x: wp.array, rings: Rings, loads: RingLoads, axes: RingAxes, shift: wp.array, tissue: Tissue
    ) -> None:
        """Find the rings that moved, and place all of them; arguments as of ``place_changed_rings``."""
        inputs = [x, rings, loads, axes, shift, tissue, UNMOVED, self.rings]
        self._launch(kernels.place_changed_rings, inputs)

    def find_rows(self, records: ContactRecords, self_contact: SelfContactForce) -> None:
        """Find the rows that have changed, once contacts are known and listed."""
        self.rows.first.zero_()
        self._launch(kernels.find_changed_rows, [records, self_contact, self.rings, self.rows])

    def forget(self, world_mask: wp.array) -> None:
        """Forget the worlds in ``world_mask``, shape (W + 1,), bool."""
        mask = wp.to_torch(world_mask)[: self._shape[1]]
        wp.to_torch(self.rings.tissue).masked_fill_(mask[None, :, None], -1.0)

    def forget_rows(self) -> None:
        """Forget all rows: the stiffness was measured without solving for what it changes."""
        self.rows.touched.fill_(1)

    def _launch(self, kernel: wp.Kernel, inputs: list[object]) -> None:
        wp.launch(kernel, self._shape, inputs=inputs, device=self._device, block_dim=GPU_BLOCK)
