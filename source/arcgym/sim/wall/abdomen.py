# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The abdomen around the colon of every world, and a hand on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.assets.abdomen_cfg import AbdomenCfg
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import abdomen_kernels as kernels
from arcgym.sim.wall.wall_parameters import WallParameters

ABDOMEN = "abdomen."
"""Begins the names of what the abdomen's future depends on."""
CORE = 0.999
"""Share of the box in a superellipsoid whose points need no powers to be known inside."""
FITTING_STEPS = 500
"""Steps in which the inside is fitted: its volume is then within a percent of the least."""


class Abdomen:
    """Inside of the abdomen, which pushes the wall back, and the dent that a hand makes. W worlds, R rings."""

    def __init__(
        self,
        cfg: AbdomenCfg,
        walls: Sequence[WallParameters],
        triangles: np.ndarray,
        members: wp.array,
        patient: wp.array,
        device: str,
    ):
        """Fit the insides to the imaged colons and allocate.

        Args:
            cfg: Settings.
            walls: Wall of each patient, a shell.
            triangles: Vertices of the shell's triangles, shape (F, 3).
            members: Vertices of each ring, -1 padded, shape (R, S).
            patient: Patient of each world, shape (W,), int32, read in every step.
            device: Warp device.
        """
        self.device, num_envs = device, len(patient)
        fits = [fit(wall.points, cfg.squareness, 0.5 * wall.thickness) for wall in walls]
        shape = self.shape = kernels.AbdomenShape()
        shape.patient, shape.members = patient, members
        shape.center = wp.array([center for center, _ in fits], dtype=wp.vec3, device=device)
        shape.tight = wp.array([axes for _, axes in fits], dtype=wp.vec3, device=device)
        shape.area = patient_array([vertex_area(wall.points, triangles) for wall in walls], float, device)
        shape.gap = wp.full(num_envs, cfg.gap, dtype=float, device=device)
        shape.stiffness = wp.full(num_envs, cfg.stiffness, dtype=float, device=device)
        shape.squareness, shape.damping = cfg.squareness, cfg.damping
        shape.core = CORE * 3.0 ** (-1.0 / cfg.squareness)
        hand = self.hand = kernels.AbdominalHand()
        hand.force, hand.dent = (wp.zeros(num_envs, dtype=float, device=device) for _ in range(2))
        hand.place = wp.zeros(num_envs, dtype=wp.vec2, device=device)
        hand.home = wp.vec2(*cfg.hand_place)
        hand.radius, hand.stiffness = cfg.hand_radius, cfg.hand_stiffness
        hand.time, hand.deepest = cfg.hand_time, cfg.hand_depth
        self.load = wp.zeros((len(members), num_envs), dtype=wp.vec3, device=device)
        self.push = wp.zeros(num_envs, dtype=float, device=device)
        """Force of the colon on the abdomen, the sum over all places [N], shape (W,)."""

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What the abdomen's future depends on, by name, as views of shape (W, n)."""
        arrays = {"dent": wp.to_torch(self.hand.dent)[:, None], "place": wp.to_torch(self.hand.place)}
        return {f"{ABDOMEN}{name}": array for name, array in arrays.items()}

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """What may differ between worlds, shape (W,) each, see :class:`arcgym.assets.AbdomenCfg`."""
        arrays = {"gap": self.shape.gap, "stiffness": self.shape.stiffness}
        return {f"{ABDOMEN}{name}": wp.to_torch(array) for name, array in arrays.items()}

    def advance(self, dt: float) -> None:
        """Move the hands by a step of ``dt`` [s], after the wall was pressed."""
        inputs, outputs = [self.load, dt], [self.hand, self.push]
        wp.launch(kernels.move_hand, len(self.push), inputs=inputs, outputs=outputs, device=self.device)

    def reset(self, ids: torch.Tensor) -> None:
        """Lift the hands in the worlds ``ids``, shape (n,), int64."""
        wp.to_torch(self.hand.force)[ids] = 0.0


def fit(points: np.ndarray, squareness: float, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """Return middle and semi-axes [m], shape (3,) each, of the least superellipsoid that holds all points.

    It lies in the middle of their bounding box. Of all with ``sum_i w_i |q_i|^n <= 1`` the least has the largest
    product of w: then ``1 / w_i = sum_k m_k |q_ki|^n`` with weights m of the points, which are found as those of a
    D-optimal design are (Titterington 1976: each times its own sum, again and again).

    Args:
        points: Positions [m], shape (V, 3).
        squareness: Exponent n.
        margin: Distance that is added to the semi-axes [m].
    """
    points = points.astype(np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    center, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), 1.0e-3)
    away = np.abs((points - center) / half) ** squareness
    weights = np.full(len(points), 3.0 / len(points))
    for _ in range(FITTING_STEPS):
        inverse = 1.0 / (weights @ away)
        weights *= away @ inverse
    inverse = 1.0 / (weights @ away)
    inverse /= (away @ inverse).max()
    return center, half * inverse ** (-1.0 / squareness) + margin


def vertex_area(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the area around each vertex, a third of its triangles [m^2], shape (V,).

    Args:
        points: Positions [m], shape (V, 3).
        triangles: Vertices, shape (F, 3).
    """
    corners = points[triangles].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.zeros(len(points))
    np.add.at(area, triangles.ravel(), np.repeat(np.linalg.norm(normal, axis=1) / 6.0, 3))
    return area
