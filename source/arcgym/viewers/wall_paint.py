# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Color of the wall: displacement, strain, anchor tension or the force of the scope on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp
from scipy.spatial.transform import Rotation

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
from arcgym.assets.patient import Patient
from arcgym.sim.model_building import wall_lumen
from arcgym.sim.wall.wall_readout import inverse_rest
from arcgym.viewers.palette import FORCE_TIERS, Tiers, deformation_colors, force_colors

WALL_COLORS = ("displacement", "strain", "tension", "force")
"""Quantities that the wall's color can show."""

_SCALES = {
    "displacement": ("wall displacement", "mm", 1000.0, 0.05),
    "strain": ("wall strain", "%", 100.0, 0.10),
    "tension": ("anchor tension", "N", 1.0, 1.0),
}
"""Title, unit, shown number of a value of one, and default value at the end of the scale."""

_CONTACT_REACH = 0.012
"""Distance from a link's surface over which its force fades out [m]."""


@dataclass(frozen=True)
class WallScale:
    """Colors from nothing to the full scale."""

    title: str
    """Name of the quantity."""
    unit: str
    """Unit of the shown number."""
    per_unit: float
    """Shown number of a value of one."""
    full: float
    """Value at the end of the scale."""
    ticks: tuple[float, ...]
    """Values to label."""
    colors: np.ndarray
    """Linear RGB at even steps from zero to ``full``, shape (K, 3)."""

    def paint(self, values: np.ndarray) -> np.ndarray:
        """Return the color of each value, linear RGB, shape (M, 3)."""
        place = np.clip(values / self.full, 0.0, 1.0) * (len(self.colors) - 1)
        steps = np.arange(len(self.colors))
        return np.stack([np.interp(place, steps, self.colors[:, channel]) for channel in range(3)], axis=1)


def wall_scale(kind: str, full: float | None = None, tiers: Tiers = FORCE_TIERS) -> WallScale:
    """Return the scale of a quantity.

    Args:
        kind: One of :data:`WALL_COLORS`.
        full: Value at the end of the scale: [m], a strain, or [N]; None for one that suits a pushed colonoscope.
        tiers: Tiers of the force and their colors.

    Raises:
        ValueError: If there is no such quantity.
    """
    if kind not in WALL_COLORS:
        raise ValueError(f"The wall cannot be colored by '{kind}'; choose one of {', '.join(WALL_COLORS)}.")
    share = np.linspace(0.0, 1.0, 257)
    if kind == "force":
        full = full or 1.07 * tiers[-1].start
        ticks = tuple(tier.start for tier in tiers[1:] if tier.start <= full)
        return WallScale("force on the wall", "N", 1.0, full, ticks, _force_table(share * full, tiers))
    title, unit, per_unit, default = _SCALES[kind]
    full = full or default
    return WallScale(title, unit, per_unit, full, (0.0, 0.5 * full, full), deformation_colors(share))


def _force_table(force: np.ndarray, tiers: Tiers) -> np.ndarray:
    """Tissue where there is no force, the tier's color from half a newton on."""
    share = np.clip(force / 0.5, 0.0, 1.0)[:, None]
    return deformation_colors(np.zeros_like(force)) * (1.0 - share) + force_colors(force, tiers) * share


class WallPaint:
    """Values of the wall of one world for the vertices of its visual surface, on the host."""

    def __init__(self, colon: Any, patient: Patient) -> None:
        """Store rest shape and skin.

        Args:
            colon: The scene's colon.
            patient: Patient of the worlds to paint; its surface for the policy's camera is what is drawn.
        """
        self._colon, self._wall = colon, patient.wall
        self._faces = wall_lumen(patient.wall).faces
        self._inverse = inverse_rest(patient.wall.points[self._faces])
        self._skin, self._weights = patient.visual.skin_indices, patient.visual.skin_weights

    def strain(self, env_id: int) -> np.ndarray:
        """Largest principal strain of the lumen faces around each vertex as they are now, shape (M,)."""
        corners = self._positions(env_id)[self._faces]
        values = np.zeros(len(self._wall.points))
        np.maximum.at(values, self._faces.ravel(), np.repeat(face_strains(corners, self._inverse), 3))
        return self._skinned(values)

    def tension(self, env_id: int) -> np.ndarray:
        """Pull of each vertex's ring on its anchors, mean over the control step [N], shape (M,)."""
        rings = self._colon.data.anchor_tension[env_id].cpu().numpy()
        return self._skinned(rings[self._wall.ring])

    def force(
        self, env_id: int, link_pos: np.ndarray, link_quat: np.ndarray, link_length: np.ndarray, link_force: np.ndarray
    ) -> np.ndarray:
        """Force shown for the hardest pressing link nearby, fading out within 12 mm of it [N], shape (M,).

        Args:
            env_id: World.
            link_pos: Middle of each link [m], shape (L, 3).
            link_quat: Orientation of each link (x, y, z, w), +Z along it, shape (L, 4).
            link_length: Length of each link [m], shape (L,).
            link_force: Force to show for each link that touches the wall, else 0 [N], shape (L,).
        """
        points = self._positions(env_id)
        value = np.zeros(len(points))
        axis, half = Rotation.from_quat(link_quat).apply([0.0, 0.0, 1.0]), 0.5 * np.asarray(link_length)
        for link in np.flatnonzero(link_force > 0.0):
            offset = points - link_pos[link]
            along = np.clip(offset @ axis[link], -half[link], half[link])
            away = np.linalg.norm(offset - along[:, None] * axis[link], axis=1)
            near = np.clip(1.0 - (away - away.min()) / _CONTACT_REACH, 0.0, 1.0)
            value = np.maximum(value, link_force[link] * near)
        return self._skinned(value)

    def _positions(self, env_id: int) -> np.ndarray:
        return wp.to_torch(self._colon.nodal_pos_wp)[:, env_id].cpu().numpy()

    def _skinned(self, values: np.ndarray) -> np.ndarray:
        return (values[self._skin] * self._weights).sum(axis=1)


def window_at_links(
    link_length: np.ndarray, touches: np.ndarray, force: np.ndarray, force_arc: np.ndarray
) -> np.ndarray:
    """Return the force of the window around the middle of each link that touches the wall, else 0 [N], shape (L,).

    Args:
        link_length: Length of each link, base first [m], shape (L,).
        touches: Whether the link touches the wall, shape (L,).
        force: Wall force on each window of the scope [N], shape (K,).
        force_arc: Distance of the middle of each window from the front of the tip [m], ascending, shape (K,).
    """
    length = np.asarray(link_length, float)
    from_tip = length.sum() - np.cumsum(length) + 0.5 * length
    return np.where(touches, np.interp(from_tip, force_arc, force), 0.0)


def face_strains(corners: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Largest principal stretch of triangles minus one, as :func:`arcgym.sim.wall.strain_kernels.face_strain` has it.

    Args:
        corners: Corners now [m], shape (F, 3, 3).
        inverse: Of the rest shape, from :func:`arcgym.sim.wall.wall_readout.inverse_rest`, shape (F, 3).

    Returns:
        Strains, zero for faces that are compressed all over, shape (F,).
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    f1 = first * inverse[:, :1]
    f2 = (second - first * inverse[:, 1:2]) * inverse[:, 2:]
    c11, c22, c12 = (f1 * f1).sum(1), (f2 * f2).sum(1), (f1 * f2).sum(1)
    largest = 0.5 * (c11 + c22) + np.hypot(0.5 * (c11 - c22), c12)
    return np.maximum(np.sqrt(largest) - 1.0, 0.0)
