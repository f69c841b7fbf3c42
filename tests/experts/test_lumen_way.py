# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The way ahead of the tip in tubes of 20 mm radius: straight, and bent by 90 degrees within 60 mm."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import torch
from tiny_sim import TinySim

from arcgym.experts.lumen_way import CLEARANCE, REACH, LumenWay, along
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg


def scene_in(folder: Path, **tube) -> InteractiveScene:
    tiny = TinySim(folder, **tube)
    cfg = InteractiveSceneCfg(num_envs=2, colon=tiny.colon_cfg(rigid=True), endoscope=tiny.scope_cfg("capsule"))
    return InteractiveScene(cfg, SimulationCfg())


def test_in_a_straight_tube_it_is_the_axis(tmp_path: Path) -> None:
    scene = scene_in(tmp_path)
    way = LumenWay(scene).find()
    assert way.shape == (2, 17, 3)
    assert torch.equal(way[:, 0], scene["endoscope"].data.tip_pos_w)
    assert way[..., :2].abs().max() < 1.0e-3
    assert float(way[0, -1, 2] - way[0, 0, 2]) == pytest.approx(REACH, abs=1.0e-3)


def test_around_a_bend_it_is_shorter_than_the_centerline_and_keeps_off_the_wall(tmp_path: Path) -> None:
    scene = scene_in(tmp_path, length=0.10, radius=0.020, bend=math.pi * 0.8, rings=33, sectors=12)
    way = LumenWay(scene).find()[0]
    length = float((way[1:] - way[:-1]).norm(dim=1).sum())
    assert 0.5 * REACH < length < 0.98 * REACH  # bend radius 40 mm, inner edge of the lumen at 20 mm
    wall = scene["colon"].data.nodal_pos_w[0]
    assert float(torch.cdist(way[2:], wall).min()) > 0.9 * CLEARANCE


def test_a_point_along_a_way_is_found_by_its_length() -> None:
    way = torch.tensor([[[0.0, 0, 0], [3, 0, 0], [3, 4, 0]]]).repeat(3, 1, 1)
    points = along(way, torch.tensor([1.0, 5.0, 9.0]))
    assert torch.allclose(points, torch.tensor([[1.0, 0, 0], [3, 2, 0], [3, 4, 0]]), atol=1.0e-5)
