# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of colon and scope from outside the patient, without GPU or display."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.viewers import outside_view_kernels as kernels
from arcgym.viewers.compositing import compose
from arcgym.viewers.palette import FORCE_TIERS, Tiers
from arcgym.viewers.scope_colors import scope_color_table
from arcgym.viewers.scope_tube import ScopeTube
from arcgym.viewers.view_camera import ViewCamera, frame_points
from arcgym.viewers.viewer_cfg import OutsideViewCfg
from arcgym.viewers.wall_paint import wall_scale

_KEY_LIGHT = np.array([-0.5, 0.75, 0.75])
_FILL_LIGHT = np.array([0.9, 0.1, 0.6])


class WallSurface(Protocol):
    """Part of :class:`arcgym.sensors.SkinnedSurface` that is drawn, of one world."""

    points: wp.array
    """Vertices [m], shape (M,), vec3."""
    normals: wp.array
    """Unit normals towards the lumen, shape (M,), vec3."""
    mesh: wp.Mesh
    """Triangles with groups."""
    roots: wp.array
    """Start of ray queries, shape (1,), int32."""


class OutsideView:
    """Draws the translucent colon of one world and the scope in it.

    The ray marcher is a Warp kernel and runs on the surface's device; shadows and background are added in numpy.
    """

    def __init__(
        self,
        cfg: OutsideViewCfg,
        surface: WallSurface,
        rest_points: np.ndarray,
        link_length: np.ndarray,
        link_radius: np.ndarray,
        force_arc: np.ndarray,
        bending_links: int = 0,
        tiers: Tiers = FORCE_TIERS,
    ) -> None:
        """Place the camera and allocate what every frame needs.

        Args:
            cfg: Camera and look.
            surface: Visual surface of one world; read at every frame.
            rest_points: Undeformed vertices of the surface [m], shape (M, 3).
            link_length: Length of each link of the scope [m], shape (L,).
            link_radius: Radius of each link [m], shape (L,).
            force_arc: Distance of the middle of each window of force from the front of the tip [m], shape (K,).
            bending_links: Number of distal links that form the bending section.
            tiers: Tiers of the force and their colors.
        """
        self.cfg = cfg
        self.surface = surface
        self.device = surface.points.device
        below = np.array([[0.0, 0.0, -cfg.outside_length]])
        self.camera: ViewCamera = frame_points(
            np.concatenate([np.asarray(rest_points), below]),
            (cfg.width, cfg.height),
            cfg.azimuth,
            cfg.elevation,
            cfg.distance,
        )
        self._rest = np.asarray(rest_points)
        self._tiers = tiers
        self.scale = wall_scale(cfg.wall_color, cfg.wall_full_scale, tiers)
        self._wall_colors = wp.zeros(len(rest_points), dtype=wp.vec3, device=self.device)
        self._link_length = np.asarray(link_length, float)
        self._force_arc = np.asarray(force_arc, float)
        self._bending_links = bending_links
        self._tube = ScopeTube(link_length, link_radius)
        self._add_scope()
        self._params = self._view_params()
        size = (cfg.height, cfg.width)
        self._color = wp.zeros(size, dtype=wp.vec4, device=self.device)
        self._refined = wp.zeros(size, dtype=wp.vec4, device=self.device)
        self._depth = wp.zeros(size, dtype=float, device=self.device)

    def render(
        self,
        link_pos: np.ndarray,
        link_quat: np.ndarray,
        force: np.ndarray,
        wall_values: np.ndarray | None = None,
    ) -> np.ndarray:
        """Draw the surface as it is now, and the scope.

        Args:
            link_pos: Middle of each link [m], shape (L, 3).
            link_quat: Orientation of each link (x, y, z, w), +Z towards the tip, shape (L, 4).
            force: Wall force on each window of the scope [N], shape (K,).
            wall_values: What the color of each vertex shows, shape (M,); None for its displacement.

        Returns:
            Picture, uint8, shape (height, width, 3).
        """
        self._update_scope(link_pos, link_quat, force)
        if wall_values is None:
            wall_values = np.linalg.norm(self.surface.points.numpy() - self._rest, axis=1)
        self._wall_colors.assign(self.scale.paint(wall_values).astype(np.float32))
        self._trace()
        return compose(self._refined.numpy(), self._depth.numpy(), kernels.FAR, self.cfg.depth_contrast)

    def _trace(self) -> None:
        inputs = [self._geometry(), self._params]
        wp.launch(
            kernels.trace_pixels,
            self._color.shape,
            inputs=inputs,
            outputs=[self._color, self._depth],
            device=self.device,
        )
        wp.launch(
            kernels.refine_edges,
            self._color.shape,
            inputs=[*inputs, self.cfg.edge_threshold, self._color],
            outputs=[self._refined],
            device=self.device,
        )

    def _add_scope(self) -> None:
        """Build the scope's mesh around a straight scope: its ray tree then follows the shaft, however it bends."""
        straight = np.zeros((len(self._link_length), 3))
        straight[:, 2] = np.cumsum(self._link_length) - 0.5 * self._link_length
        vertices, normals = self._tube.sweep(straight, np.tile([0.0, 0.0, 0.0, 1.0], (len(straight), 1)))
        self._scope_points = self._array(vertices, wp.vec3)
        self._scope_normals = self._array(normals, wp.vec3)
        self._scope_arcs = self._array(self._tube.arc, float)
        self._scope_mesh = wp.Mesh(self._scope_points, self._array(self._tube.faces.ravel(), int))
        self._scope_table = self._array(self._table(np.zeros(len(self._force_arc))), wp.vec3)

    def _update_scope(self, link_pos: np.ndarray, link_quat: np.ndarray, force: np.ndarray) -> None:
        vertices, normals = self._tube.sweep(link_pos, link_quat)
        self._scope_points.assign(vertices)
        self._scope_normals.assign(normals)
        self._scope_mesh.refit()
        self._scope_table.assign(self._table(force).astype(np.float32))

    def _table(self, force: np.ndarray) -> np.ndarray:
        shown = force if self.cfg.scope_color == "force" else np.zeros_like(force)
        return scope_color_table(self._link_length, self._bending_links, shown, self._force_arc, self._tiers)

    def _geometry(self) -> kernels.ViewGeometry:
        geometry = kernels.ViewGeometry()
        geometry.wall = self.surface.mesh.id
        geometry.root = self.surface.roots
        geometry.wall_normals = self.surface.normals
        geometry.wall_colors = self._wall_colors
        geometry.scope = self._scope_mesh.id
        geometry.scope_normals = self._scope_normals
        geometry.scope_arcs = self._scope_arcs
        geometry.scope_table = self._scope_table
        return geometry

    def _view_params(self) -> kernels.ViewParams:
        camera, params = self.camera, kernels.ViewParams()
        params.eye = wp.vec3(*camera.eye)
        params.right = wp.vec3(*(camera.right * camera.tan_half[0]))
        params.up = wp.vec3(*(camera.up * camera.tan_half[1]))
        params.forward = wp.vec3(*camera.forward)
        axes = np.stack([camera.right, camera.up, -camera.forward])
        params.key_light = wp.normalize(wp.vec3(*(_KEY_LIGHT @ axes)))
        params.fill_light = wp.normalize(wp.vec3(*(_FILL_LIGHT @ axes)))
        params.width, params.height = camera.size
        params.near_alpha, params.rim_alpha = self.cfg.near_alpha, self.cfg.rim_alpha
        params.far_alpha, params.ghost_alpha = self.cfg.far_alpha, self.cfg.ghost_alpha
        params.scope_share = self.cfg.scope_share
        params.table_step = float(self._link_length.sum()) / len(self._scope_table)
        return params

    def _array(self, values: np.ndarray, dtype: type) -> wp.array:
        return wp.array(np.asarray(values), dtype=dtype, device=self.device)
