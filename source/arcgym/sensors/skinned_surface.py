# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface of the colon in every world, skinned to the simulated wall and ready for ray queries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from arcgym.sensors.ray_tree import LEAF_ON_CPU, LEAF_ON_GPU, RayTree, TreeLayout
from arcgym.sensors.shared_tree import TreeShape, sorted_faces
from arcgym.sensors.skinning_cuda_kernels import VERTICES, skin_parts, wall_frame_numbers
from arcgym.sensors.skinning_kernels import skin_vertices, wall_frames
from arcgym.utils import warp_setup  # noqa: F401

if TYPE_CHECKING:
    from arcgym.anatomy.shell import ShellMesh
    from arcgym.anatomy.stage import VisualMesh, WallMesh


class SkinnedSurface:
    """A visual mesh that follows the wall by linear blend skinning with one frame per wall vertex.

    Every frame is built from the vertex's neighbors along and around the colon, so folds turn with the wall instead
    of being sheared. :meth:`update` only launches kernels, so that it can be captured in a graph.

    Every world has one of P patients; surfaces of fewer vertices or triangles than the largest are filled up. One
    patient's tree is that of its rest shape; several patients share one, see :mod:`arcgym.sensors.shared_tree`.
    """

    points: wp.array
    """Deformed vertices of all worlds [m], shape (num_envs * M,), vec3."""
    normals: wp.array
    """Unit normals towards the lumen, shape (num_envs * M,), vec3."""
    mesh: RayTree
    """Triangles of all worlds, in boxes for ray queries."""
    roots: wp.array
    """Where ray queries of a world start, shape (num_envs,), int32."""

    def __init__(
        self,
        visual: VisualMesh | Sequence[VisualMesh],
        wall: WallMesh | ShellMesh | Sequence[WallMesh | ShellMesh],
        num_envs: int,
        device: str,
        patient: wp.array | None = None,
    ) -> None:
        """Bind surfaces to the rest shapes of their walls.

        Args:
            visual: Surface of the patient, or of each.
            wall: Wall of the patient, or of each; all on one grid.
            num_envs: Number of worlds.
            device: Warp device.
            patient: Patient of each world, shape (num_envs,), int32, read at every update; None for the first.

        Raises:
            ValueError: If a surface does not fit its wall.
        """
        visuals = list(visual) if isinstance(visual, Sequence) else [visual]
        walls = list(wall) if isinstance(wall, Sequence) else [wall]
        for surface, carrier in zip(visuals, walls, strict=True):
            _check_binding(surface, carrier)
        self.num_envs = num_envs
        self.num_nodes = len(walls[0].points)
        self.num_vertices = max(len(one.points) for one in visuals)
        self.device = device
        self.patient = wp.zeros(num_envs, dtype=int, device=device) if patient is None else patient
        self._device = wp.get_device(device)
        self._everywhere = wp.full(num_envs, True, dtype=wp.bool, device=device)
        self._neighbors = wp.array(walls[0].frame_neighbors, dtype=wp.vec4i, device=device)
        if self._device.is_cuda:
            self._frames = wp.zeros((self.num_nodes, 9, num_envs), dtype=float, device=device)
        else:
            self._frames = wp.zeros((self.num_nodes, num_envs), dtype=wp.mat33, device=device)
        self._bind(visuals, walls)
        count = num_envs * self.num_vertices
        self.points = wp.zeros(count, dtype=wp.vec3, device=device)
        self.normals = wp.zeros(count, dtype=wp.vec3, device=device)
        self.mesh = RayTree(*self._tree(visuals, walls[0]), self.points, self.patient)
        self.roots = self.mesh.roots
        rest = np.stack([one.points for one in walls], axis=1)[:, self.patient.numpy()]
        self.update(wp.array(rest, dtype=wp.vec3, device=device))

    def update(self, nodal_pos: wp.array, drawn: wp.array | None = None) -> None:
        """Move the surface to the wall's present shape.

        Args:
            nodal_pos: Wall vertices of all worlds [m], shape (V, num_envs), vec3.
            drawn: Worlds to move, shape (num_envs,), bool; the others keep their vertices bit for bit. None: all.
        """
        drawn = self._everywhere if drawn is None else drawn
        self._skin(nodal_pos, drawn)
        self.mesh.fit(drawn)

    def _skin(self, nodal_pos: wp.array, drawn: wp.array) -> None:
        """Launch the two skinning kernels."""
        on_gpu = self._device.is_cuda
        wp.launch(
            wall_frame_numbers if on_gpu else wall_frames,
            (self.num_nodes, self.num_envs),
            inputs=[nodal_pos, self._neighbors, drawn],
            outputs=[self._frames],
            device=self.device,
        )
        parts = -(-self.num_vertices // VERTICES)
        wp.launch(
            skin_parts if on_gpu else skin_vertices,
            (parts if on_gpu else self.num_vertices, self.num_envs),
            inputs=[nodal_pos, self._frames, self.patient, *self._binding, drawn],
            outputs=[self.points, self.normals],
            device=self.device,
        )

    def _bind(self, visuals: list[VisualMesh], walls: list[WallMesh | ShellMesh]) -> None:
        """Store offsets and normals of the visual vertices in the frames of the wall vertices that carry them."""
        count = len(walls)
        rest = wp.array(np.stack([one.points for one in walls], axis=1), dtype=wp.vec3, device=self.device)
        frames = wp.zeros((self.num_nodes, count), dtype=wp.mat33, device=self.device)
        everywhere = wp.full(count, True, dtype=wp.bool, device=self.device)
        wp.launch(
            wall_frames,
            (self.num_nodes, count),
            inputs=[rest, self._neighbors, everywhere],
            outputs=[frames],
            device=self.device,
        )
        index = np.zeros((self.num_vertices, count, 4), np.int32)
        weights = np.zeros((self.num_vertices, count, 4), np.float32)
        offsets, normals = (np.zeros((self.num_vertices, 4, count, 3), np.float32) for _ in range(2))
        for p, (visual, wall, frame) in enumerate(zip(visuals, walls, frames.numpy().swapaxes(0, 1), strict=True)):
            own, carried = slice(len(visual.points)), frame[visual.skin_indices]
            index[own, p], weights[own, p] = visual.skin_indices, visual.skin_weights
            away = visual.points[:, None] - wall.points[visual.skin_indices]
            offsets[own, :, p] = np.einsum("vkji,vkj->vki", carried, away)
            normals[own, :, p] = np.einsum("vkji,vj->vki", carried, visual.normals)
        self._binding = (
            wp.array(index, dtype=wp.vec4i, device=self.device),
            wp.array(weights, dtype=wp.vec4, device=self.device),
            wp.array(offsets, dtype=wp.vec3, device=self.device),
            wp.array(normals, dtype=wp.vec3, device=self.device),
        )

    def _tree(self, visuals: list[VisualMesh], wall: WallMesh | ShellMesh) -> tuple[TreeLayout, np.ndarray]:
        """Return the shape of the ray tree of all patients, and the triangles of each in its order, shape (P, F, 3)."""
        leaf = LEAF_ON_CPU if self._device.is_cpu else LEAF_ON_GPU
        if len(visuals) == 1:
            faces = visuals[0].faces.astype(np.int32)
            return TreeLayout.of(visuals[0].points, faces, "sah", leaf), faces[None]
        shape = TreeShape(max(len(one.faces) for one in visuals), self.num_vertices)
        return TreeLayout.of(shape.points, shape.faces, "median", leaf), sorted_faces(visuals, wall, shape)


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
