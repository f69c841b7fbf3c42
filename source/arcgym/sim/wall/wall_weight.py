# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Weight of the walls of all worlds and of their contents."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import weight_kernels
from arcgym.sim.wall.wall_kernels import Tissue, WallNodes
from arcgym.sim.wall.wall_parameters import WallParameters
from arcgym.sim.weight_cfg import WeightCfg


class WallWeight:
    """What the walls weigh more, or elsewhere, than when their shape was imaged. V vertices, W worlds."""

    def __init__(
        self,
        cfg: WeightCfg,
        walls: Sequence[WallParameters],
        ring_arcs: Sequence[np.ndarray],
        gravity: wp.array,
        device: str,
    ):
        """Spread wall and contents over the vertices.

        Args:
            cfg: Settings.
            walls: Wall of each patient.
            ring_arcs: Arc length of each patient's rings [m], shape (R,).
            gravity: Acceleration of free fall in each world [m/s^2], shape (W,), vec3, read in every step.
            device: Warp device.
        """
        self.gravity, self._device = gravity, device
        self._imaged = wp.vec3(*cfg.gravity(cfg.imaged))
        loads = [weighing(cfg, wall, arc) / wall.mass for wall, arc in zip(walls, ring_arcs, strict=True)]
        self._load = patient_array(loads, float, device)

    @property
    def inputs(self) -> list[Any]:
        """What kernels take of it: masses over the vertices' own, gravity of now and of the image."""
        return [self._load, self.gravity, self._imaged]

    def add(self, nodes: WallNodes, tissue: Tissue, dt: float, inertial: wp.array) -> None:
        """Let the weight move ``inertial`` [m], where inertia takes the wall in a step, shape (V, W), vec3.

        Args:
            nodes: Vertices of all patients.
            tissue: Values of each world.
            dt: Physics step [s].
            inertial: Positions; moved in place.
        """
        inputs = [nodes, tissue, dt, *self.inputs]
        wp.launch(weight_kernels.add_weight, inertial.shape, inputs=inputs, outputs=[inertial], device=self._device)


def weighing(cfg: WeightCfg, wall: WallParameters, ring_arc: np.ndarray) -> np.ndarray:
    """Return the mass that hangs on each vertex [kg], shape (V,): its share of the wall and of the contents.

    Args:
        cfg: Settings.
        wall: The wall.
        ring_arc: Arc length of its rings [m], shape (R,).
    """
    members = np.bincount(wall.ring, minlength=len(ring_arc))
    contents = cfg.contents_per_length * np.gradient(ring_arc) / members
    return cfg.wall_share * wall.mass + contents[wall.ring]
