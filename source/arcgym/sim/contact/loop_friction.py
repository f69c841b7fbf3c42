# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Friction where loops of the colon touch."""

from __future__ import annotations

import torch
import warp as wp

from arcgym.sim.contact import loop_friction_kernels as kernels
from arcgym.sim.contact import self_contact_group_kernels as group_kernels
from arcgym.sim.contact.self_contact import SelfContact
from arcgym.sim.loop_friction_cfg import LoopFrictionCfg
from arcgym.sim.wall.outer_force_kernels import OuterForce
from arcgym.utils.warp_setup import GPU_BLOCK

LOOPS = "loops."
"""Begins the names of what friction's future depends on. A state without it has loops that have not slid yet."""
SLOTS = 8
"""Rings that a ring may be tied to; it touches five of the next loop at most, if their rings are as long."""


class LoopFriction:
    """Ties between rings of the wall that touch. R rings, W worlds."""

    def __init__(self, cfg: LoopFrictionCfg, rings: int, num_envs: int, device: str):
        """Allocate.

        Args:
            cfg: Settings.
            rings: Number of rings.
            num_envs: Number of worlds.
            device: Warp device.
        """
        self._device = device
        self.friction = wp.full(num_envs, cfg.friction, dtype=float, device=device)
        """Coulomb coefficient of each world, shape (W,)."""
        self.ties = kernels.Ties()
        self.ties.partner = wp.zeros((rings, SLOTS, num_envs), dtype=int, device=device)
        self.ties.slid = wp.zeros((rings, SLOTS, num_envs), dtype=wp.vec3, device=device)
        self.ties.stiffness = cfg.stiffness

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What friction's future depends on, by name, as views of shape (W, R, K, ...)."""
        partner, slid = wp.to_torch(self.ties.partner), wp.to_torch(self.ties.slid)
        return {f"{LOOPS}partner": partner.permute(2, 0, 1), f"{LOOPS}slid": slid.permute(2, 0, 1, 3)}

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """What may differ between worlds, shape (W,)."""
        return {"loop_friction": wp.to_torch(self.friction)}

    def measure(self, x: wp.array, v: wp.array, contact: SelfContact, dt: float, outer: OuterForce) -> None:
        """Add the drag of a step to ``outer``.

        Args:
            x: Wall positions at which ``contact`` was measured [m], shape (V, W), vec3.
            v: Wall velocities [m/s], shape (V, W), vec3.
            contact: Contact of the wall with itself.
            dt: Physics step [s].
            outer: Forces; added to.
        """
        if not contact.active:
            return
        inputs = [x, v, contact.rings, contact.spheres, contact.force, self.friction, dt]
        shape: tuple[int, ...] = contact.force.in_contact.shape
        kernel = kernels.rub_loops
        if contact.lanes > 0:
            kernel, shape = group_kernels.rub_loops_in_groups, (*shape, contact.lanes)
            inputs = [*inputs, contact.lanes]
        outputs = [self.ties, outer]
        wp.launch(kernel, shape, inputs=inputs, outputs=outputs, device=self._device, block_dim=GPU_BLOCK)
