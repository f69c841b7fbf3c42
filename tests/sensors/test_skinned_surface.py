# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface follows the wall."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import warp as wp
from tube_scene import MIDDLE, tube_visual, tube_wall

from arcgym.sensors import SkinnedSurface
from arcgym.sensors.skinning_cuda_kernels import VERTICES, skin_parts, wall_frame_numbers


def make(num_envs: int = 1) -> tuple[SkinnedSurface, np.ndarray, np.ndarray]:
    wall = tube_wall()
    visual = tube_visual(wall)
    return SkinnedSurface(visual, wall, num_envs, "cpu"), wall.points, visual.points


def wall_array(*worlds: np.ndarray) -> wp.array:
    return wp.array(np.stack(worlds, axis=1).astype(np.float32), dtype=wp.vec3, device="cpu")


def test_rest_shape_is_exact():
    surface, wall, visual = make()
    surface.update(wall_array(wall))
    assert np.abs(surface.points.numpy() - visual).max() < 1.0e-6


def test_quarter_turn_of_the_wall_turns_points_and_normals():
    surface, wall, visual = make()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    rest_normals = surface.normals.numpy().copy()
    surface.update(wall_array(wall @ turn.T + (0.1, 0.0, 0.0)))
    assert np.allclose(surface.points.numpy(), visual @ turn.T + (0.1, 0.0, 0.0), atol=1.0e-6)
    assert np.allclose(surface.normals.numpy(), rest_normals @ turn.T, atol=1.0e-5)


def test_masked_world_keeps_its_vertices():
    surface, wall, visual = make(num_envs=2)
    moved = wall + (0.0, 0.01, 0.0)
    only_second = wp.array([False, True], dtype=wp.bool, device="cpu")
    surface.update(wall_array(moved, moved), only_second)
    first, second = surface.points.numpy().reshape(2, -1, 3)
    assert np.array_equal(first, surface.points.numpy()[: len(visual)]) and np.allclose(first, visual, atol=1.0e-6)
    assert np.allclose(second, visual + (0.0, 0.01, 0.0), atol=1.0e-6)


@pytest.mark.parametrize("left_out", [0, 1])
def test_kernels_for_a_gpu_do_what_those_for_a_cpu_do(left_out: int):
    surface, wall, visual = make(num_envs=3)
    bent = wall + 0.01 * np.sin(40.0 * wall[:, 2:]) * np.array([1.0, 0.5, 0.0])
    nodes = wall_array(wall, bent, bent + 0.1)
    surface.update(nodes)
    count = len(visual) - left_out
    drawn = wp.array([True, False, True], dtype=wp.bool, device="cpu")
    frames = wp.zeros((len(wall), 9, 3), dtype=float, device="cpu")
    inputs = [nodes, surface._neighbors, drawn]
    wp.launch(wall_frame_numbers, (len(wall), 3), inputs=inputs, outputs=[frames], device="cpu")
    binding = [array[:count].contiguous() for array in surface._binding]
    found = [wp.zeros(3 * count, dtype=wp.vec3, device="cpu") for _ in range(2)]
    inputs = [nodes, frames, surface.patient, *binding, drawn]
    wp.launch(skin_parts, (-(-count // VERTICES), 3), inputs=inputs, outputs=found, device="cpu")
    for own, expected, tolerance in zip(found, (surface.points, surface.normals), (1.0e-7, 1.0e-6), strict=True):
        values, wanted = own.numpy().reshape(3, count, 3), expected.numpy().reshape(3, -1, 3)[:, :count]
        np.testing.assert_allclose(values[[0, 2]], wanted[[0, 2]], atol=tolerance)
        assert not values[1].any()


def test_foreign_wall_is_refused():
    wall = tube_wall()
    short = dataclasses.replace(wall, points=wall.points[:100])
    with pytest.raises(ValueError, match="wall has 100 vertices"):
        SkinnedSurface(tube_visual(wall), short, 1, "cpu")


def two_patients() -> tuple[list, list]:
    """A tube as it is and one wider and half as long, with a coarser surface; both on the same grid of the wall."""
    walls = [tube_wall(), tube_wall(radius=0.03)]
    walls[1] = dataclasses.replace(walls[1], points=walls[1].points * np.array([1.0, 1.0, 0.5], np.float32))
    visuals = [tube_visual(walls[0]), tube_visual(walls[1], radius=0.03)]
    half = visuals[1].points * np.array([1.0, 1.0, 0.5], np.float32)
    visuals[1] = dataclasses.replace(visuals[1], points=half, faces=visuals[1].faces[::2])
    return visuals, walls


def triangles(surface: SkinnedSurface, world: int) -> np.ndarray:
    """Corners of a world's triangles that have an area, sorted, shape (F, 3, 3)."""
    indices = surface.mesh.indices.numpy().reshape(surface.num_envs, -1, 3)[world]
    corners = surface.points.numpy()[indices]
    corners = corners[np.ptp(corners, axis=1).max(axis=1) > 0.0]
    return corners[np.lexsort(corners[:, 0].round(6).T)]


def test_each_world_has_the_surface_of_its_patient_and_takes_another_one():
    visuals, walls = two_patients()
    patient = wp.array([0, 1, 1], dtype=int, device="cpu")
    surface = SkinnedSurface(visuals, walls, 3, "cpu", patient)
    for wanted in ([0, 1, 1], [1, 1, 0]):
        patient.assign(wanted)
        surface.update(wall_array(*(walls[p].points for p in wanted)))
        for world, p in enumerate(wanted):
            expected = visuals[p].points[visuals[p].faces]
            expected = expected[np.lexsort(expected[:, 0].round(6).T)]
            found = triangles(surface, world)
            assert len(found) == len(expected)
            np.testing.assert_allclose(np.sort(found.reshape(-1)), np.sort(expected.reshape(-1)), atol=1.0e-6)


@wp.kernel
def shoot(
    mesh: wp.uint64,
    roots: wp.array[int],
    origin: wp.array[wp.vec3],
    direction: wp.array[wp.vec3],
    distance: wp.array2d[float],
):
    world, ray = wp.tid()
    query = wp.mesh_query_ray(mesh, origin[ray], direction[ray], 1.0, roots[world])
    distance[world, ray] = wp.where(query.result, query.t, -1.0)


def test_rays_meet_the_same_triangles_as_with_a_tree_of_the_patients_own():
    visuals, walls = two_patients()
    patient = wp.array([0, 1], dtype=int, device="cpu")
    shared = SkinnedSurface(visuals, walls, 2, "cpu", patient)
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    rays = [wp.array(values, dtype=wp.vec3, device="cpu") for values in (np.tile(MIDDLE, (200, 1)) * 0.5, directions)]
    for order in ([0, 1], [1, 0]):
        patient.assign(order)
        shared.update(wall_array(*(walls[p].points for p in order)))
        found = wp.zeros((2, 200), dtype=float, device="cpu")
        wp.launch(shoot, (2, 200), inputs=[shared.mesh.id, shared.roots, *rays], outputs=[found], device="cpu")
        for world, p in enumerate(order):
            own = SkinnedSurface(visuals[p], walls[p], 1, "cpu")
            expected = wp.zeros((1, 200), dtype=float, device="cpu")
            wp.launch(shoot, (1, 200), inputs=[own.mesh.id, own.roots, *rays], outputs=[expected], device="cpu")
            np.testing.assert_allclose(found.numpy()[world], expected.numpy()[0], atol=1.0e-6)
            assert (found.numpy()[world] > 0.0).sum() > 60
