# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures from outside show the colon, the scope, its forces and the deformation."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from tiny import tiny_colon_stage

from arcgym.sensors import SkinnedSurface
from arcgym.viewers import OutsideView, OutsideViewCfg

LENGTH = np.full(8, 0.02)
ARC = np.array([0.025, 0.050, 0.075, 0.100, 0.125])
CFG = {"width": 96, "height": 80}


@pytest.fixture(scope="module")
def stage():
    return tiny_colon_stage()


def make_view(stage, **overrides) -> OutsideView:
    surface = SkinnedSurface(stage.visual_proxy, stage.wall, 1, "cpu")
    cfg = OutsideViewCfg(**CFG, **overrides)
    return OutsideView(cfg, surface, stage.visual_proxy.points, LENGTH, np.full(8, 0.006), ARC, bending_links=3)


def draw(view: OutsideView, tip: float = 0.1, force: float = 0.0) -> np.ndarray:
    position = np.zeros((8, 3))
    position[:, 2] = tip - 0.15 + np.arange(8) * 0.02
    return view.render(position, np.tile([0.0, 0.0, 0.0, 1.0], (8, 1)), np.full(5, force)).astype(int)


def test_picture_has_size_and_content(stage):
    picture = make_view(stage).render(np.zeros((8, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (8, 1)), np.zeros(5))
    assert picture.shape == (80, 96, 3) and picture.dtype == np.uint8
    assert picture.std() > 5.0


def test_ground_is_light_and_colon_is_reddish(stage):
    picture = draw(make_view(stage), tip=0.02)
    assert picture[40, 4].min() > 190
    x, y = make_view(stage).camera.project(np.array([[0.0, 0.0, 0.15]]))[0].astype(int)
    red, _, blue = picture[y, x]
    assert red > blue + 30


def test_moving_scope_changes_the_picture(stage):
    view = make_view(stage)
    changed = np.abs(draw(view, tip=0.05) - draw(view, tip=0.15)).max(axis=2) > 10
    assert changed.sum() > 10
    assert changed.mean() < 0.2


def test_force_colors_the_scope(stage):
    view = make_view(stage)
    rest, unsafe, perforation = (draw(view, force=force) for force in (0.0, 8.0, 20.0))
    x, y = view.camera.project(np.array([[0.0, 0.0, -0.04]]))[0].astype(int)
    assert unsafe[y, x, 0] > rest[y, x, 0] + 60
    assert perforation[y, x, 2] > unsafe[y, x, 2] + 30


def test_deformation_turns_the_wall_from_red_to_blue(stage):
    view = make_view(stage, wall_full_scale=0.01)
    rest = draw(view, tip=0.02)
    view.surface.update(wp.array((stage.wall.points + np.array([0.01, 0.0, 0.0]))[:, None], dtype=wp.vec3))
    moved = draw(view, tip=0.02)
    x, y = view.camera.project(np.array([[0.01, 0.0, 0.15]]))[0].astype(int)
    assert rest[y, x, 0] > rest[y, x, 2]
    assert moved[y, x, 0] < moved[y, x, 2]


def test_scope_shows_through_the_wall(stage):
    view = make_view(stage)
    x, y = view.camera.project(np.array([[0.0, 0.0, 0.05]]))[0].astype(int)
    assert draw(view, tip=0.02)[y, x].sum() > draw(view, tip=0.15)[y, x].sum() + 60


def test_anti_aliasing_softens_edges_only(stage):
    smooth, jagged = draw(make_view(stage)), draw(make_view(stage, edge_threshold=2.0))
    differs = (smooth != jagged).any(axis=2)
    assert 0.005 < differs.mean() < 0.4


def test_same_state_gives_the_same_picture(stage):
    view = make_view(stage)
    first = draw(view, tip=0.1)
    draw(view, tip=0.15)
    np.testing.assert_array_equal(first, draw(view, tip=0.1))
