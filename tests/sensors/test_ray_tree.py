# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The tree of boxes in which rays find the triangles of their world."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from tube_scene import MIDDLE, tube_visual, tube_wall

from arcgym.sensors import ray_tree
from arcgym.sensors.ray_tree import RayTree, TreeLayout


def tube(builder: str, leaf: int) -> tuple[TreeLayout, np.ndarray, np.ndarray]:
    visual = tube_visual(tube_wall())
    faces = visual.faces.astype(np.int32)
    return TreeLayout.of(visual.points, faces, builder, leaf), visual.points, faces


@pytest.mark.parametrize(("builder", "leaf"), [("sah", 4), ("sah", 2), ("median", 4), ("sah", 100000)])
def test_layout_holds_every_triangle_once_and_siblings_beside_each_other(builder: str, leaf: int) -> None:
    layout, _, faces = tube(builder, leaf)
    assert np.array_equal(np.sort(layout.order), np.arange(len(faces)))
    number, first, second, is_leaf = layout.nodes.T
    assert len(np.unique(number)) == len(number) and number.max() < layout.size
    assert 0 in number and 1 not in number
    inner = is_leaf == 0
    assert np.array_equal(np.sort(np.append(0, layout.nodes[inner, 1:3].ravel())), np.sort(number))
    assert (first[inner] % 2 == 0).all() and np.array_equal(second[inner], first[inner] + 1)
    held = np.concatenate([np.arange(a, b) for a, b in zip(first[~inner], second[~inner], strict=True)])
    assert np.array_equal(np.sort(held), np.arange(len(faces)))
    assert (second - first)[~inner].max() <= leaf


def test_children_are_fitted_in_batches_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ray_tree, "PIECE", 64)
    monkeypatch.setattr(ray_tree, "LOW", 2)
    layout, _, _ = tube("sah", 2)
    assert layout.starts[0] == 0 and layout.starts[-1] == len(layout.nodes) and (np.diff(layout.starts) > 0).all()
    batch = np.full(layout.size, -1)
    batch[layout.nodes[:, 0]] = np.repeat(np.arange(len(layout.starts) - 1), np.diff(layout.starts))
    inner = layout.nodes[layout.nodes[:, 3] == 0]
    assert (batch[inner[:, 1:3]] < batch[inner[:, :1]]).all() and (batch[inner[:, 1:3]] >= 0).all()


@wp.kernel
def shoot(
    mesh: wp.uint64, root: wp.array[int], origin: wp.vec3, direction: wp.array[wp.vec3], corners: wp.array2d[wp.vec3]
):
    ray = wp.tid()
    query = wp.mesh_query_ray(mesh, origin, direction[ray], 1.0, root[root.shape[0] - 1])
    if query.result:
        for k in range(3):
            corners[ray, k] = wp.mesh_get_point(mesh, 3 * query.face + k)


def hits(mesh: int, roots: wp.array, origin: np.ndarray) -> np.ndarray:
    """Corners of the triangles that 500 rays from a point meet in the last world, shape (500, 3, 3)."""
    directions = np.random.default_rng(0).normal(size=(500, 3))
    rays = wp.array(directions / np.linalg.norm(directions, axis=1, keepdims=True), dtype=wp.vec3, device="cpu")
    found = wp.zeros((500, 3), dtype=wp.vec3, device="cpu")
    wp.launch(shoot, 500, inputs=[mesh, roots, wp.vec3(*map(float, origin)), rays], outputs=[found], device="cpu")
    return found.numpy()


@pytest.mark.parametrize("leaf", [2, 4, 100000])
def test_rays_meet_the_triangles_that_they_meet_in_a_mesh_of_warp(leaf: int) -> None:
    layout, rest, faces = tube("sah", leaf)
    bent = rest + 0.01 * np.sin(40.0 * rest[:, 2:]) * np.array([1.0, 0.5, 0.0])
    points = wp.array(np.concatenate([rest + 0.003, rest]), dtype=wp.vec3, device="cpu")
    tree = RayTree(layout, faces[None], points, wp.zeros(2, dtype=int, device="cpu"))
    tree.fit(wp.array([True, True], dtype=wp.bool, device="cpu"))
    points.assign(np.concatenate([bent, bent]))
    tree.fit(wp.array([False, True], dtype=wp.bool, device="cpu"))
    mesh = wp.Mesh(wp.array(bent, dtype=wp.vec3, device="cpu"), wp.array(faces.ravel(), dtype=int, device="cpu"))
    expected = hits(mesh.id, wp.array([-1], dtype=int, device="cpu"), MIDDLE)
    assert np.array_equal(hits(tree.id, tree.roots, MIDDLE), expected)
    assert np.ptp(expected, axis=1).max(axis=1).astype(bool).sum() > 200


def test_a_world_that_is_not_drawn_keeps_its_boxes() -> None:
    layout, rest, faces = tube("sah", 4)
    points = wp.array(np.concatenate([rest, rest]), dtype=wp.vec3, device="cpu")
    tree = RayTree(layout, faces[None], points, wp.zeros(2, dtype=int, device="cpu"))
    tree.fit(wp.array([True, True], dtype=wp.bool, device="cpu"))
    before = tree._lowers.numpy().reshape(2, -1, 4)[:, :, :3].copy()
    points.assign(np.concatenate([rest, rest]) + 0.5)
    tree.fit(wp.array([False, True], dtype=wp.bool, device="cpu"))
    after = tree._lowers.numpy().reshape(2, -1, 4)[:, :, :3]
    used = layout.nodes[:, 0]
    assert np.array_equal(after[0], before[0])
    np.testing.assert_allclose(after[1, used], before[1, used] + 0.5, atol=1.0e-6)
