# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface of the colon in every world, skinned to the simulated wall and ready for ray queries."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from arcgym.sensors.skinning_kernels import group_roots, skin_vertices, wall_frames
from arcgym.utils import warp_setup  # noqa: F401

if TYPE_CHECKING:
    from arcgym.anatomy.shell import ShellMesh
    from arcgym.anatomy.stage import VisualMesh, WallMesh


class SkinnedSurface:
    """A visual mesh that follows the wall by linear blend skinning with one frame per wall vertex.

    Every frame is built from the vertex's neighbours along and around the colon, so folds turn with the wall instead
    of being sheared. All worlds share one mesh whose triangles are grouped by world: a ray that starts at a world's
    root meets no other world. :meth:`update` only launches kernels and can be captured in a CUDA graph; CPU graphs of
    Warp 1.19 do not record the refit of a mesh, so there it has to run beside the graph.
    """

    points: wp.array
    """Deformed vertices of all worlds [m], shape (num_envs * M,), vec3."""
    normals: wp.array
    """Unit normals towards the lumen, shape (num_envs * M,), vec3."""
    mesh: wp.Mesh
    """Triangles of all worlds, grouped by world."""
    roots: wp.array
    """Where ray queries of a world start, shape (num_envs,), int32."""

    def __init__(self, visual: VisualMesh, wall: WallMesh | ShellMesh, num_envs: int, device: str) -> None:
        """Bind `visual` to the rest shape of `wall`, once for all `num_envs` worlds."""
        _check_binding(visual, wall)
        self.num_envs = num_envs
        self.num_nodes = len(wall.points)
        self.num_vertices = len(visual.points)
        self.device = device
        self._device = wp.get_device(device)
        self._everywhere = wp.full(num_envs, True, dtype=wp.bool, device=device)
        self._neighbors = wp.array(wall.frame_neighbors, dtype=wp.vec4i, device=device)
        self._frames = wp.zeros((self.num_nodes, num_envs), dtype=wp.mat33, device=device)
        self._bind(visual, wall)
        count = num_envs * self.num_vertices
        self.points = wp.zeros(count, dtype=wp.vec3, device=device)
        self.normals = wp.zeros(count, dtype=wp.vec3, device=device)
        rest = wp.array(np.repeat(wall.points[:, None], num_envs, axis=1), dtype=wp.vec3, device=device)
        self._skin(rest, self._everywhere)
        self.mesh = self._build_mesh(visual.faces)
        self.roots = wp.zeros(num_envs, dtype=int, device=device)
        wp.launch(group_roots, num_envs, inputs=[self.mesh.id], outputs=[self.roots], device=device)

    def update(self, nodal_pos: wp.array, drawn: wp.array | None = None) -> None:
        """Move the surface to the wall's present shape.

        Args:
            nodal_pos: Wall vertices of all worlds [m], shape (V, num_envs), vec3.
            drawn: Worlds to move, shape (num_envs,), bool; the others keep their vertices bit for bit. None: all.

        Raises:
            RuntimeError: While a CPU graph is being captured, which would silently leave out the refit.
        """
        if self._device.is_cpu and self._device.is_capturing:
            raise RuntimeError(
                "SkinnedSurface.update() inside a CPU graph capture: Warp does not record wp.Mesh.refit() there, and a"
                " replay would trace rays through a stale tree. Update the camera outside the capture, or use CUDA."
            )
        self._skin(nodal_pos, self._everywhere if drawn is None else drawn)
        self.mesh.refit()

    def _skin(self, nodal_pos: wp.array, drawn: wp.array) -> None:
        """Launch the two skinning kernels."""
        wp.launch(
            wall_frames,
            (self.num_nodes, self.num_envs),
            inputs=[nodal_pos, self._neighbors, drawn],
            outputs=[self._frames],
            device=self.device,
        )
        wp.launch(
            skin_vertices,
            (self.num_vertices, self.num_envs),
            inputs=[nodal_pos, self._frames, *self._binding, drawn],
            outputs=[self.points, self.normals],
            device=self.device,
        )

    def _bind(self, visual: VisualMesh, wall: WallMesh | ShellMesh) -> None:
        """Store offsets and normals of the visual vertices in the frames of the wall vertices that carry them."""
        rest = wp.array(wall.points[:, None], dtype=wp.vec3, device=self.device)
        wp.launch(
            wall_frames,
            (self.num_nodes, 1),
            inputs=[rest, self._neighbors, self._everywhere],
            outputs=[self._frames],
            device=self.device,
        )
        index = visual.skin_indices
        frames = self._frames.numpy()[:, 0][index]
        offsets = np.einsum("vkji,vkj->vki", frames, visual.points[:, None] - wall.points[index])
        normals = np.einsum("vkji,vj->vki", frames, visual.normals)
        self._binding = (
            wp.array(index, dtype=wp.vec4i, device=self.device),
            wp.array(visual.skin_weights, dtype=wp.vec4, device=self.device),
            wp.array(offsets.astype(np.float32), dtype=wp.vec3, device=self.device),
            wp.array(normals.astype(np.float32), dtype=wp.vec3, device=self.device),
        )

    def _build_mesh(self, faces: np.ndarray) -> wp.Mesh:
        """Build the grouped mesh; its tree is made once and only refitted after.

        A CPU builds by the surface-area heuristic. That takes 12 ms a world, on the CPU for a GPU as well; a GPU builds
        by Morton codes at once (lbvh). With two faces a leaf it then draws as fast, and refits 1.7 ms slower at 1024
        worlds (``arcgym bench camera`` on an H100).
        """
        first = np.arange(self.num_envs, dtype=np.int32) * self.num_vertices
        indices = (faces.reshape(1, -1).astype(np.int32) + first[:, None]).ravel()
        groups = np.repeat(np.arange(self.num_envs, dtype=np.int32), len(faces))
        return wp.Mesh(
            self.points,
            wp.array(indices, dtype=int, device=self.device),
            groups=wp.array(groups, dtype=int, device=self.device),
            bvh_constructor="sah" if self._device.is_cpu else "lbvh",
            bvh_leaf_size=4 if self._device.is_cpu else 2,
        )


def _check_binding(visual: VisualMesh, wall: WallMesh | ShellMesh) -> None:
    """Raise where the skin does not fit the wall."""
    top = int(visual.skin_indices.max())
    if top >= len(wall.points):
        raise ValueError(
            f"The visual mesh is skinned to wall vertex {top}, but the wall has {len(wall.points)} vertices."
            " Use a visual mesh and a wall of the same stage."
        )
    error = float(np.abs(visual.skin_weights.sum(axis=1) - 1.0).max())
    if error > 1.0e-3:
        raise ValueError(f"Skin weights of the visual mesh sum to 1 ± {error:.3g}; expected 1 for every vertex.")
