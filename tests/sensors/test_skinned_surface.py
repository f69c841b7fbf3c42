# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The visual surface follows the wall."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import warp as wp
from tube_scene import tube_visual, tube_wall

from arcgym.sensors import SkinnedSurface


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


def test_foreign_wall_is_refused():
    wall = tube_wall()
    short = dataclasses.replace(wall, points=wall.points[:100])
    with pytest.raises(ValueError, match="wall has 100 vertices"):
        SkinnedSurface(tube_visual(wall), short, 1, "cpu")
