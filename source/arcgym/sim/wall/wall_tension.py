# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Loads that hold the imaged shape where tension and pressure of a tube do not balance each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import warp as wp

from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import wall_tension_kernels as kernels
from arcgym.sim.wall.gas_kernels import GasLaw, GasLoads, LumenRings
from arcgym.sim.wall.ring_modes import RingModes
from arcgym.sim.wall.wall_parameters import WallParameters


class WallTension:
    """What keeps walls under tension at rest in the shape in which they were imaged. R rings, V vertices, W worlds."""

    def __init__(
        self,
        walls: Sequence[WallParameters],
        modes: Sequence[RingModes],
        triangles: np.ndarray,
        ties: Sequence[np.ndarray],
        pressure: float,
        loads: GasLoads,
        device: str,
    ):
        """Measure what tension and pressure leave over in the imaged shapes.

        Args:
            walls: Wall of each patient.
            modes: Its ring modes.
            triangles: Vertices of the shell's triangles, shape (F, 3).
            ties: Tension of each patient under 1 Pa, shape (3*F, 2), see :func:`.lumen_gas.ties`.
            pressure: Pressure across the wall when it was imaged [Pa].
            loads: What the gas does to the walls; ``hold`` is written in every step.
            device: Warp device.
        """
        self._loads, self._device = loads, device
        held = self._held = kernels.HeldShape()
        held.members = wp.array(modes[0].members, dtype=int, device=device)
        held.plane = patient_array([one.plane for one in modes], wp.vec2, device)
        load = [
            pressure * holding(wall.points.astype(np.float64), triangles, tie, wall.ring, mode)
            for wall, mode, tie in zip(walls, modes, ties, strict=True)
        ]
        held.load = patient_array(load, wp.vec3, device)

    def turn(self, x: wp.array) -> None:
        """Turn the loads with the rings at ``x`` [m], shape (V, W), vec3."""
        shape = (len(self._held.members), x.shape[1])
        wp.launch(kernels.turn_loads, shape, inputs=[x, self._held], outputs=[self._loads], device=self._device)

    def measure(self, x: wp.array, lumen: LumenRings, law: GasLaw, parts: wp.array) -> None:
        """Measure the lumen at ``x`` [m], shape (V, W), vec3, too.

        Args:
            x: Wall positions.
            lumen: Faces that close the lumen.
            law: Settings of the gas.
            parts: Parts of the lumen's volume [m^3], shape (R, W); written.
        """
        inputs, outputs = [x, lumen, law, self._held], [parts, self._loads]
        wp.launch(kernels.measure_held_slices, parts.shape, inputs=inputs, outputs=outputs, device=self._device)


def holding(
    points: np.ndarray, triangles: np.ndarray, ties: np.ndarray, ring: np.ndarray, modes: RingModes
) -> np.ndarray:
    """Return the loads that hold a shape under a pressure of 1 Pa and its tension, in its rings' frames [m^2].

    Args:
        points: Imaged positions [m], shape (V, 3).
        triangles: Vertices, shape (F, 3).
        ties: Tension under 1 Pa as springs along the edges [m], shape (3*F, 2).
        ring: Ring of each vertex, shape (V,).
        modes: Modes of the rings.
    """
    load = np.zeros_like(points)
    corners = points[triangles]
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 6.0
    pulls = ties.reshape(-1, 3, 2)
    for a in range(3):
        one, two = triangles[:, (a + 1) % 3], triangles[:, (a + 2) % 3]
        here = triangles[:, a]
        pull = pulls[:, a, :1] * (points[one] - points[here]) + pulls[:, a, 1:] * (points[two] - points[here])
        np.add.at(load, here, -pull - outwards)
    return np.einsum("vij,vi->vj", frames(points, ring, modes)[ring], load)


def frames(points: np.ndarray, ring: np.ndarray, modes: RingModes) -> np.ndarray:
    """Return the frame of each ring, its columns along p, q and across both, shape (R, 3, 3).

    Args:
        points: Positions [m], shape (V, 3).
        ring: Ring of each vertex, shape (V,).
        modes: Modes of the rings.
    """
    moments = np.zeros((len(modes.members), 2, 3))
    np.add.at(moments, ring, modes.plane[:, :, None] * points[:, None])
    p = moments[:, 0] / np.linalg.norm(moments[:, 0], axis=1, keepdims=True)
    q = moments[:, 1] - (moments[:, 1] * p).sum(axis=1, keepdims=True) * p
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    return np.stack([p, q, np.cross(p, q)], axis=2)
