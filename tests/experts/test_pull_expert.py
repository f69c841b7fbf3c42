# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The expert for a tip that is pulled, two worlds of a straight tube."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.experts import PullExpert
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg


def test_a_tip_rolls_to_and_fro_where_it_is_told_to(tmp_path: Path) -> None:
    tube = TinySim(tmp_path)
    cfg = InteractiveSceneCfg(num_envs=2, colon=tube.colon_cfg(rigid=True), endoscope=tube.scope_cfg("capsule"))
    scene = InteractiveScene(cfg, SimulationCfg())
    expert = PullExpert(scene, roll=torch.tensor([0.0, 6.0]))
    rolls = []
    for _ in range(15):
        expert.act()
        rolls.append(wp.to_torch(scene["endoscope"].actuators["tip"].angular)[:, 2].tolist())
    still, rolled = zip(*rolls, strict=True)
    assert still == (0.0,) * 15
    assert (rolled[4], rolled[9], rolled[14]) == pytest.approx((6.0, 0.0, -6.0), abs=1.0e-5)  # a period of 20 steps
