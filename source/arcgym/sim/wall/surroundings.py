# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What lies around the walls of all worlds and pushes or pulls on them, besides their anchors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.sim.contact.bend_contact import limbs_that_touch
from arcgym.sim.contact.loop_friction import LoopFriction
from arcgym.sim.contact.self_contact import SelfContact
from arcgym.sim.wall import outer_force_kernels as kernels
from arcgym.sim.wall.abdomen import Abdomen
from arcgym.sim.wall.band_kernels import Rings
from arcgym.sim.wall.mesentery import Mesentery
from arcgym.sim.wall.ring_modes import MODES
from arcgym.sim.wall.surroundings_kernels import Around, measure_surroundings
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.sim.wall.wall_readout import WallReadout


class Surroundings:
    """Forces of the surroundings, measured once a step and linear within it. V vertices, R rings, W worlds."""

    def __init__(
        self,
        ring: np.ndarray,
        members: wp.array,
        num_envs: int,
        device: str,
        abdomen: Abdomen | None = None,
        mesentery: Mesentery | None = None,
        friction: LoopFriction | None = None,
        bends: bool = False,
    ):
        """Allocate.

        Args:
            ring: Ring of each vertex, shape (V,).
            members: Vertices of each ring, -1 padded, shape (R, S).
            num_envs: Number of worlds.
            device: Warp device.
            abdomen: The abdomen, if there is one.
            mesentery: The mesenteries, if they are sheets.
            friction: Friction between loops, if there is any.
            bends: Whether the limbs of one bend push on each other.
        """
        self.abdomen, self.mesentery, self.friction = abdomen, mesentery, friction
        self._members, self._device, self._bends = members, device, bends
        self.force = kernels.OuterForce()
        """Their force on every vertex."""
        self.force.ring = wp.array(ring, dtype=int, device=device)
        self.force.push = wp.zeros((len(ring), num_envs), dtype=wp.vec3, device=device)
        self.force.stiffness = wp.zeros((len(ring), num_envs), dtype=wp.mat33, device=device)
        self.force.near = wp.zeros((len(members), num_envs), dtype=int, device=device)
        around = self._around = Around()
        around.members = members
        if abdomen is not None:
            around.pressing, around.shape, around.hand, around.load = 1, abdomen.shape, abdomen.hand, abdomen.load
        if mesentery is not None:
            around.pulling, around.sheets = 1, mesentery.sheets

    def bind(self, contact: SelfContact, points: Sequence[np.ndarray]) -> None:
        """Take the contact of the wall with itself, which measures its rings before :meth:`measure`.

        Args:
            contact: The contact.
            points: Rest positions of each patient's wall [m], shape (V, 3).
        """
        if self._bends:
            self._around.folding, self._around.bends = 1, limbs_that_touch(contact, points)

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What their future depends on, by name, as views of shape (W, ...)."""
        kept = [part.memory for part in (self.abdomen, self.friction) if part is not None]
        return {name: value for memory in kept for name, value in memory.items()}

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """What may differ between worlds, by name, shape (W,) each."""
        return {name: value for part in self._parts() for name, value in part.settings.items()}

    def _parts(self) -> list[Abdomen | Mesentery | LoopFriction]:
        return [part for part in (self.abdomen, self.mesentery, self.friction) if part is not None]

    def measure(self, x: wp.array, tissue: Tissue, dt: float) -> None:
        """Measure the forces of a step of ``dt`` [s] at positions ``x`` [m], shape (V, W), vec3."""
        shape, inputs = self.force.near.shape, [x, self._around, tissue.anchor, dt]
        wp.launch(measure_surroundings, shape, inputs=inputs, outputs=[self.force], device=self._device)

    def advance(self, x: wp.array, v: wp.array, contact: SelfContact, dt: float) -> None:
        """Begin a step of ``dt`` [s], after :meth:`measure`: add friction between loops, and move the hands.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            v: Wall velocities [m/s], shape (V, W), vec3.
            contact: Contact of the wall with itself, measured at ``x``.
            dt: Physics step [s].
        """
        if self.friction is not None:
            self.friction.measure(x, v, contact, dt, self.force)
        if self.abdomen is not None:
            self.abdomen.advance(dt)

    def read(self, x: wp.array, tissue: Tissue, readout: WallReadout) -> None:
        """Add the pulls of sheets at ``x`` [m], shape (V, W), vec3, to the tensions that the readout measured there."""
        if self.mesentery is not None:
            self.mesentery.read(x, tissue, readout)

    def add_rows(self, rings: Rings, tissue: Tissue, diagonal: wp.array) -> None:
        """Add their stiffness to the rings' ``diagonal`` blocks [N/m], shape (R, W, 9, 9)."""
        inputs = [self._members, rings.plane, rings.moves, rings.patient, tissue.rigid, self.force]
        shape = (*self.force.near.shape, MODES)
        wp.launch(kernels.add_outer_rows, shape, inputs=inputs, outputs=[diagonal], device=self._device)

    def reset(self, ids: torch.Tensor) -> None:
        """Forget the commands in the worlds ``ids``, shape (n,), int64."""
        if self.abdomen is not None:
            self.abdomen.reset(ids)
