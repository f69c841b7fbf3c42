# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The tube of the scope follows the links."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arcgym.viewers.palette import FORCE_TIERS, force_colors, force_tier, to_display
from arcgym.viewers.scope_colors import scope_color_table
from arcgym.viewers.scope_tube import ScopeTube

LENGTH = np.full(5, 0.02)
RADIUS = np.full(5, 0.006)
STRAIGHT = np.tile([0.0, 0.0, 0.0, 1.0], (5, 1))


def centers() -> np.ndarray:
    return np.stack([np.zeros(5), np.zeros(5), np.arange(5) * 0.02 + 0.01], axis=1)


def test_straight_links_make_a_round_ended_cylinder():
    vertices, normals = ScopeTube(LENGTH, RADIUS).sweep(centers(), STRAIGHT)
    middle = (vertices[:, 2] > 0.005) & (vertices[:, 2] < 0.095)
    np.testing.assert_allclose(np.linalg.norm(vertices[middle, :2], axis=1), 0.006, rtol=1e-5)
    np.testing.assert_allclose(normals[middle, :2], vertices[middle, :2] / 0.006, atol=1e-5)
    assert vertices[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert vertices[:, 2].max() == pytest.approx(0.1, abs=1e-6)


def test_faces_point_outwards():
    tube = ScopeTube(LENGTH, RADIUS)
    vertices, normals = tube.sweep(centers(), STRAIGHT)
    a, b, c = (vertices[tube.faces[:, k]] for k in range(3))
    facing = np.sum(np.cross(b - a, c - a) * normals[tube.faces[:, 0]], axis=1)
    assert (facing > -1e-9).all()


def test_bend_is_smooth_and_passes_through_the_links():
    angle = np.arange(5) * 0.4
    axis = np.stack([np.sin(angle), np.zeros(5), np.cos(angle)], axis=1)
    position = np.cumsum(0.02 * axis, axis=0) - 0.01 * axis
    quaternion = np.stack([np.zeros(5), np.sin(angle / 2), np.zeros(5), np.cos(angle / 2)], axis=1)
    vertices, _ = ScopeTube(LENGTH, RADIUS, sides=16).sweep(position, quaternion)
    rings = vertices.reshape(-1, 16, 3).mean(axis=1)
    nearest = np.linalg.norm(rings[None] - position[:, None], axis=2).min(axis=1)
    assert nearest.max() < 0.003
    steps = np.diff(rings, axis=0)[6:-6]
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    turn = np.arccos(np.clip(np.sum(steps[1:] * steps[:-1], axis=1), -1, 1))
    assert turn.max() < 0.25


def test_single_link_capsule():
    vertices, normals = ScopeTube(np.array([0.02]), np.array([0.005])).sweep(np.zeros((1, 3)), STRAIGHT[:1])
    assert np.isfinite(vertices).all() and np.isfinite(normals).all()
    assert np.ptp(vertices[:, 2]) == pytest.approx(0.02, abs=1e-6)


@pytest.mark.parametrize(
    ("force", "label"), [(0.0, "comfort"), (3.0, "discomfort"), (5.0, "unsafe"), (20.0, "perforation")]
)
def test_forces_fall_into_tiers(force, label):
    tier = force_tier(force)
    assert tier.label == label
    assert tuple(to_display(force_colors(np.array([force])))[0]) == tier.color


def test_perforation_starts_at_the_published_force():
    assert FORCE_TIERS[-1].start == 14.1


def test_color_table_marks_tip_bending_section_and_force():
    length = np.full(20, 0.02)
    arc = 0.025 * np.arange(1, 16)
    rest = scope_color_table(length, 5, np.zeros(15), arc)
    assert len(rest) == 400
    assert rest[-1].min() > 0.7
    assert rest[350].sum() > rest[250].sum()
    # The window 0.3 m from the tip, 0.1 m from the base: its color fades out 25 mm to either side.
    loaded = scope_color_table(length, 5, np.where(np.isclose(arc, 0.3), 8.0, 0.0), arc)
    assert loaded[110][0] > 3 * rest[110][0]
    np.testing.assert_array_equal(loaded[126:], rest[126:])


def test_color_table_takes_a_short_capsule():
    table = scope_color_table(np.array([0.02]), 0, np.zeros(1), np.array([0.01]))
    assert math.isfinite(table.sum()) and len(table) == 20
