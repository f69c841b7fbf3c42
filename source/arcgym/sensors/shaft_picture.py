# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The scope's own shaft in a picture."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from arcgym.sensors.shaft_kernels import cast_shaft, mark_shaft
from arcgym.sensors.surface_renderer import SurfaceRenderer


class ShaftPicture:
    """Draws the links behind the one that carries the camera as capsules, between the wall and the exposure."""

    def __init__(self, endoscope: Any, renderer: SurfaceRenderer, rays: wp.array) -> None:
        """Allocate.

        Args:
            endoscope: The scope of all worlds.
            renderer: What draws the wall; its radiance is changed where the shaft is nearer.
            rays: Direction of the middle of each pixel in the camera's frame, shape (H, W, 1).
        """
        device, stage = renderer.device, endoscope.stage
        self._endoscope, self._renderer, self._rays = endoscope, renderer, rays
        self._radius = wp.array(np.asarray(stage.link_radius, np.float32), dtype=float, device=device)
        self._half = wp.array(0.5 * np.asarray(stage.link_length, np.float32), dtype=float, device=device)
        self._distance = wp.full(renderer.shape, -1.0, dtype=float, device=device)
        self._normal = wp.zeros(renderer.shape, dtype=wp.vec3, device=device)

    def draw(self, poses: wp.array) -> None:
        """Find the shaft from camera poses, shape (N,), and put it into the renderer's radiance."""
        renderer, data = self._renderer, self._endoscope.data
        position = wp.from_torch(data.body_pos_w.contiguous(), dtype=wp.vec3)
        rotation = wp.from_torch(data.body_quat_w.contiguous(), dtype=wp.quat)
        wp.launch(
            cast_shaft,
            renderer.shape,
            inputs=[
                position,
                rotation,
                self._radius,
                self._half,
                renderer.lighting,
                poses,
                self._rays,
                renderer.covered,
                renderer.depth,
            ],
            outputs=[renderer.radiance, self._distance, self._normal],
            device=renderer.device,
        )

    def mark(self, depth: wp.array, normal: wp.array, label: wp.array, kind: int) -> None:
        """Write depth, normal and label of the shaft where it was seen by the last :meth:`draw`."""
        wp.launch(
            mark_shaft,
            self._renderer.shape,
            inputs=[self._distance, self._normal, wp.uint8(kind)],
            outputs=[depth, normal, label],
            device=self._renderer.device,
        )
