# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Color of the wall on the tiny tube: radius 20 mm, 17 rings of 8 vertices, 12.5 mm apart, two worlds."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp
from tiny import tiny_colon_stage

from arcgym.assets.patient import patient_of_stage
from arcgym.envs.mdp import ForceTiersCfg
from arcgym.viewers.palette import deformation_colors, force_colors, shown_tiers
from arcgym.viewers.wall_paint import WallPaint, wall_scale, window_at_links

STAGE = tiny_colon_stage()
PATIENT = patient_of_stage(STAGE, shell=False)
SKIN = STAGE.visual_proxy


def make_colon(second: np.ndarray) -> SimpleNamespace:
    """World 0 is at rest, world 1 at the given positions; ring 6 of world 1 pulls with 2 N."""
    tension = torch.zeros(2, 17)
    tension[1, 6] = 2.0
    points = wp.array(np.stack([STAGE.wall.points, second], axis=1), dtype=wp.vec3)
    data = SimpleNamespace(anchor_tension=tension)
    return SimpleNamespace(nodal_pos_wp=points, data=data)


def test_strain_is_that_of_the_chosen_world() -> None:
    paint = WallPaint(make_colon(STAGE.wall.points * np.array([1.0, 1.0, 1.25], np.float32)), PATIENT)
    np.testing.assert_allclose(paint.strain(0), 0.0, atol=1e-5)
    np.testing.assert_allclose(paint.strain(1), 0.25, atol=1e-4)


def test_tension_is_shown_where_its_ring_is() -> None:
    values = WallPaint(make_colon(STAGE.wall.points), PATIENT).tension(1)
    share = (SKIN.skin_weights * (STAGE.wall.ring[SKIN.skin_indices] == 6)).sum(axis=1)
    np.testing.assert_allclose(values, 2.0 * share, atol=1e-6)
    assert values.max() > 1.0


def test_force_is_shown_beside_the_link_that_presses() -> None:
    quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    middle = np.array([[0.015, 0.0, 0.05], [0.0, 0.0, 0.15]])
    paint = WallPaint(make_colon(STAGE.wall.points), PATIENT)
    values = paint.force(0, middle, quaternions, np.full(2, 0.02), np.array([6.0, 0.0]))
    top = SKIN.points[values.argmax()]
    assert 5.0 < values.max() <= 6.0
    assert top[0] > 0.01 and abs(top[2] - 0.05) < 0.015
    assert values[np.abs(SKIN.points[:, 2] - 0.15) < 0.01].max() == 0.0


def test_a_link_that_touches_is_painted_with_the_force_of_its_window() -> None:
    # Middles of three links of 20 mm, base first: 50, 30 and 10 mm from the front; windows have theirs at 25 and 50 mm.
    touches = np.array([True, True, False])
    values = window_at_links(np.full(3, 0.02), touches, np.array([1.0, 6.0]), np.array([0.025, 0.050]))
    np.testing.assert_allclose(values, [6.0, 2.0, 0.0])


def test_force_scale_has_the_colors_of_the_tasks_tiers() -> None:
    tiers = shown_tiers(ForceTiersCfg(comfort=1.0, unsafe=3.0, perforation=10.0))
    scale = wall_scale("force", tiers=tiers)
    np.testing.assert_allclose(scale.paint(np.array([0.0])), deformation_colors(np.zeros(1)))
    np.testing.assert_allclose(
        scale.paint(np.array([2.0, 10.4])), force_colors(np.array([2.0, 10.4]), tiers), atol=1e-2
    )


def test_scale_ends_at_its_full_value() -> None:
    scale = wall_scale("strain", 0.4)
    np.testing.assert_allclose(scale.paint(np.array([0.0, 0.4, 9.0])), deformation_colors(np.array([0.0, 1.0, 1.0])))


def test_unknown_quantity_lists_the_known() -> None:
    with pytest.raises(ValueError, match="'stress'; choose one of displacement, strain, tension, force"):
        wall_scale("stress")
