# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Draws frames: the endoscope's view, and the colon's surface and the scope for the view from outside."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from arcgym.sensors import SkinnedSurface
from arcgym.teleop.frames import Frame
from arcgym.viewers.palette import Tiers, to_display
from arcgym.viewers.scope_colors import scope_color_table

SIDES = 12
"""Corners of the scope's cross-section."""


class Looker:
    """Draws one world from copies of its state, beside the thread that steps it."""

    def __init__(self, env: Any, tiers: Tiers, size: int) -> None:
        """Build surfaces and renderer, while the environment stands still.

        Args:
            env: The environment.
            tiers: Tiers of force and their colors.
            size: Width and height of the endoscope's view [px].
        """
        colon, scope = env.scene["colon"], env.scene["endoscope"]
        self._patient, self._device = colon.patient_of(0), str(env.device)
        self._surface = SkinnedSurface(self._patient.visual, self._patient.wall, 1, self._device)
        self.faces: np.ndarray = self._patient.visual.faces
        """Triangles of the colon's surface, shape (F, 3)."""
        camera = env.scene.sensors.get("camera")
        self._renderer = None if camera is None else camera.still_renderer(0, size)
        self._looks = None if camera is None else camera.looks.of_world(0)
        self._drawn = wp.full(1, True, dtype=wp.bool, device=self._device)
        stage = scope.stage
        self._tiers, self._window_arc = tiers, scope.data.window_arc.cpu().numpy()
        self._lengths, self._bending = np.asarray(stage.link_length, float), stage.bending_links
        self.link_scale = np.stack([stage.link_radius, stage.link_radius, self._lengths], axis=1).astype(np.float32)
        """Radius, radius and length of each link [m], shape (L, 3)."""

    def picture(self, frame: Frame) -> np.ndarray:
        """Return the endoscope's view, uint8, shape (size, size, 3); black where the robot has no camera."""
        if self._renderer is None:
            return np.zeros((64, 64, 3), np.uint8)
        self._renderer.gain.zero_()
        self._renderer.surface.update(self._nodes(frame))
        pose = wp.array(frame.camera_pose[None], dtype=wp.transform, device=self._device)
        self._renderer.draw(pose, self._looks, self._drawn)
        return self._renderer.rgb.numpy()[0].copy()

    def surface(self, frame: Frame) -> np.ndarray:
        """Return the vertices of the colon's surface [m], shape (M, 3)."""
        self._surface.update(self._nodes(frame))
        return self._surface.points.numpy()[: len(self._patient.visual.points)].copy()

    def link_colors(self, frame: Frame) -> np.ndarray:
        """Return the color of each link by the force of the wall beside it, uint8, shape (L, 3)."""
        table = scope_color_table(self._lengths, self._bending, frame.window_force, self._window_arc, self._tiers)
        middle = np.cumsum(self._lengths) - 0.5 * self._lengths
        place = (middle / self._lengths.sum() * len(table)).astype(int).clip(0, len(table) - 1)
        return to_display(table[place])

    def _nodes(self, frame: Frame) -> wp.array:
        return wp.array(frame.nodal_pos[:, None], dtype=wp.vec3, device=self._device)


def link_mesh() -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles of a link of radius and length one, along Z around the origin, ends rounded off."""
    angle = np.arange(SIDES) * 2.0 * np.pi / SIDES
    rings = [(-0.62, 0.55), (-0.5, 1.0), (0.5, 1.0), (0.62, 0.55)]
    vertices = [[r * np.cos(a), r * np.sin(a), z] for z, r in rings for a in angle] + [[0, 0, -0.66], [0, 0, 0.66]]
    faces = []
    for ring in range(len(rings) - 1):
        for k in range(SIDES):
            a, b = ring * SIDES + k, ring * SIDES + (k + 1) % SIDES
            faces += [[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]
    last, low, high = (len(rings) - 1) * SIDES, len(vertices) - 2, len(vertices) - 1
    for k in range(SIDES):
        faces += [[low, (k + 1) % SIDES, k], [high, last + k, last + (k + 1) % SIDES]]
    return np.array(vertices, np.float32), np.array(faces, np.int32)
