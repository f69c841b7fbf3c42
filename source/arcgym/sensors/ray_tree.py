# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The tree of boxes in which rays find the triangles of their world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import warp as wp

from arcgym.sensors.ray_tree_kernels import MESH_BYTES, describe_mesh, fit_boxes, read_tree, write_faces
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_block_kernels import LANES, lanes

LEAF_ON_CPU = 4
"""Triangles in a leaf at most."""
LEAF_ON_GPU = 2
"""The same on a GPU."""
LOW = 4
"""Height up to which nodes are fitted piece by piece, so that a GPU still has the children in its cache."""
PIECE = 4096
"""Nodes of such a piece."""


@dataclass(frozen=True)
class TreeLayout:
    """Where the nodes of one world lie in memory, and in which order they are fitted.

    The root is node 0 and node 1 stays empty; two siblings lie beside each other, which a ray reads together, and are
    followed by what is below the left one, then by what is below the right one.
    """

    nodes: np.ndarray
    """Number, two children or first and end triangle, and whether it is a leaf, of each node, shape (E, 4), int32."""
    starts: np.ndarray
    """First node of each batch, then E, int32; the children of a batch's nodes are in batches before."""
    order: np.ndarray
    """Triangles in the order of the leaves, shape (F,), int32."""

    @property
    def size(self) -> int:
        """Nodes of a world, with the empty one."""
        return int(self.nodes[:, 0].max()) + 1 + (len(self.nodes) == 1)

    @classmethod
    def of(cls, points: np.ndarray, faces: np.ndarray, builder: str, leaf: int) -> TreeLayout:
        """Lay out the tree that Warp makes on a CPU.

        Args:
            points: Vertices [m], shape (M, 3).
            faces: Triangles, shape (F, 3).
            builder: Warp's name of the way to build it: ``sah`` by the boxes' surfaces, ``median`` by halves.
            leaf: Triangles in a leaf at most.
        """
        mesh = wp.Mesh(
            wp.array(points, dtype=wp.vec3, device="cpu"),
            wp.array(faces.ravel(), dtype=int, device="cpu"),
            bvh_constructor=builder,
            bvh_leaf_size=leaf,
        )
        nodes = wp.zeros(2 * len(faces) - 1, dtype=wp.vec3i, device="cpu")
        order = wp.zeros(len(faces), dtype=int, device="cpu")
        wp.launch(read_tree, 2 * len(faces), inputs=[mesh.id], outputs=[nodes, order], device="cpu")
        numbered, height = _numbered(nodes.numpy())
        low = height <= LOW
        piece = np.where(low, -(numbered[:, 0] // PIECE), 1)
        sorting = np.lexsort((numbered[:, 0], height, piece))
        batch = np.stack([piece, height])[:, sorting]
        starts = np.flatnonzero(np.append(True, (np.diff(batch, axis=1) != 0).any(axis=0)))
        return cls(numbered[sorting], np.append(starts, len(numbered)).astype(np.int32), order.numpy())


def _numbered(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Give the nodes of a tree numbers by their places in memory.

    Args:
        nodes: Two children and 0, or two triangles and 1, of each node, shape (n, 3); the root comes first.

    Returns:
        Number, children or triangles, and whether it is a leaf, shape (E, 4), and the height of each node above the
        leaves, of two siblings the larger, shape (E,).
    """
    levels, inner = [np.array([0])], np.zeros(1, int)
    while len(inner := inner[nodes[inner, 2] == 0]) > 0:
        inner = nodes[inner, :2].ravel()
        levels.append(inner)
    below, height = np.zeros(len(nodes), int), np.zeros(len(nodes), int)
    """Inner nodes below a node, itself among them; height of a node alone."""
    for level in reversed(levels):
        inner = level[nodes[level, 2] == 0]
        below[inner] = 1 + below[nodes[inner, :2]].sum(axis=1)
        height[inner] = 1 + height[nodes[inner, :2]].max(axis=1)
    number, pair, of_pair = np.zeros(len(nodes), int), np.ones(len(nodes), int), height.copy()
    """Place of a node; place of its children over two; larger height of it and its sibling."""
    for level in levels:
        inner = level[nodes[level, 2] == 0]
        left, right = nodes[inner, 0], nodes[inner, 1]
        number[left], number[right] = 2 * pair[inner], 2 * pair[inner] + 1
        pair[left], pair[right] = pair[inner] + 1, pair[inner] + 1 + below[left]
        of_pair[left] = of_pair[right] = np.maximum(height[left], height[right])
    used = np.concatenate(levels)
    is_leaf = nodes[used, 2] == 1
    points_to = np.where(is_leaf[:, None], nodes[used, :2], number[np.where(is_leaf[:, None], 0, nodes[used, :2])])
    return np.column_stack([number[used], points_to, is_leaf]).astype(np.int32), of_pair[used]


class RayTree:
    """Boxes around the triangles of every world, in one tree whose shape all worlds share.

    Warp's ray queries take :attr:`id` for a mesh and start at a world's root, and so meet no other world. Warp would
    build a tree of its own for each world, and refit those of all worlds together, climbing from every triangle; here a
    block of threads fits a world, and only those that are drawn.
    """

    id: int
    """What ray queries take."""
    indices: wp.array
    """Corners of the triangles of all worlds, shape (3 * num_envs * F,), int32."""
    roots: wp.array
    """Where ray queries of a world start, shape (num_envs,), int32."""

    def __init__(self, layout: TreeLayout, faces: np.ndarray, points: wp.array, patient: wp.array) -> None:
        """Allocate the boxes; they enclose nothing before the first :meth:`fit`.

        Args:
            layout: Shape of the tree.
            faces: Triangles of each patient, shape (P, F, 3), in the order that the layout was made of.
            points: Vertices of all worlds, shape (num_envs * M,), vec3.
            patient: Patient of each world, shape (num_envs,), int32, read at every fit.
        """
        device = self._device = points.device
        self.num_envs, self._points, self._patient = len(patient), points, patient
        self._vertices, self._size = len(points) // self.num_envs, layout.size
        by_leaf = faces[:, layout.order].swapaxes(0, 1).astype(np.int32)
        count = self.num_envs * len(by_leaf)
        self._faces = wp.array(by_leaf.copy(), dtype=wp.vec3i, device=device)
        self._several = len(faces) > 1
        self._written = wp.full(self.num_envs, -1, dtype=int, device=device)
        self._nodes = wp.array(layout.nodes, dtype=wp.vec4i, device=device)
        self._starts = wp.array(layout.starts, dtype=int, device=device)
        self._lowers, self._uppers = (
            wp.zeros(self.num_envs * self._size, dtype=wp.vec4, device=device) for _ in range(2)
        )
        self.indices = wp.zeros(3 * count, dtype=int, device=device)
        self.roots = wp.array(np.arange(self.num_envs, dtype=np.int32) * self._size, dtype=int, device=device)
        self._order = wp.array(np.arange(count, dtype=np.int32), dtype=int, device=device)
        self._described = wp.zeros(MESH_BYTES // 8, dtype=wp.uint64, device=device)
        wp.launch(
            describe_mesh,
            1,
            inputs=[points, self.indices, self._lowers, self._uppers, self._order, self.roots],
            outputs=[self._described],
            device=device,
        )
        self.id = int(self._described.ptr)
        self._write_faces()

    def fit(self, drawn: wp.array) -> None:
        """Fit the boxes of the worlds marked in `drawn`, shape (num_envs,), bool, to their vertices."""
        if self._several:
            self._write_faces()
        together = lanes(self._device)
        wp.launch(
            fit_boxes,
            (self.num_envs, together),
            inputs=[
                self._points,
                self._faces,
                self._patient,
                self._nodes,
                self._starts,
                self._vertices,
                self._size,
                together,
                drawn,
            ],
            outputs=[self._lowers, self._uppers],
            block_dim=LANES,
            device=self._device,
        )

    def _write_faces(self) -> None:
        """Give worlds that have another patient than before that patient's triangles."""
        wp.launch(
            write_faces,
            (self.num_envs, LANES),
            inputs=[self._faces, self._patient, self._written, self._vertices, LANES],
            outputs=[self.indices],
            device=self._device,
        )
        wp.copy(self._written, self._patient)
