# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The expert for a tip that is pulled, three worlds of a straight tube."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.experts import PullExpert, make_expert, pull_expert
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg


@pytest.fixture
def scene(tmp_path: Path) -> InteractiveScene:
    tube = TinySim(tmp_path)
    cfg = InteractiveSceneCfg(num_envs=3, colon=tube.colon_cfg(rigid=True), endoscope=tube.scope_cfg("capsule"))
    return InteractiveScene(cfg, SimulationCfg())


def test_a_tip_rolls_to_and_fro_where_it_is_told_to(scene: InteractiveScene) -> None:
    """Worlds that do not roll, that roll in 2 s, 20 control steps, and in 4 s."""
    expert = PullExpert(scene, roll=torch.tensor([0.0, 6.0, 6.0]), roll_time=torch.tensor([2.0, 2.0, 4.0]))
    rolls = []
    for _ in range(15):
        expert.act()
        rolls.append(wp.to_torch(scene["endoscope"].actuators["tip"].angular)[:, 2].tolist())
    still, fast, slow = zip(*rolls, strict=True)
    assert still == (0.0,) * 15
    assert (fast[4], fast[9], fast[14]) == pytest.approx((6.0, 0.0, -6.0), abs=1.0e-5)
    assert slow[9] == pytest.approx(6.0, abs=1.0e-5)


def test_a_tip_rolls_and_rests_where_enough_of_its_tether_is_inside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Worlds that never rest, that rest for half of 2 s, 10 of 20 control steps, and below 0; nothing is pulled yet."""
    tube = TinySim(tmp_path)
    cfg = InteractiveSceneCfg(num_envs=3, colon=tube.colon_cfg(rigid=True), endoscope=tube.scope_cfg("magnetic"))
    scene = InteractiveScene(cfg, SimulationCfg())
    inside = float(scene["endoscope"].data.inserted_length[0])
    expert = PullExpert(scene, roll=6.0, roll_time=2.0, rest=torch.tensor([0.0, 0.5, -0.5]))
    for tethered, share, times in ((2.0 * inside, 0.5, 0), (inside, 1.0, 10)):
        monkeypatch.setattr(pull_expert, "TETHERED", tethered)
        expert.reset(torch.arange(3))
        forward, roll = [], []
        for _ in range(20):
            expert.act()
            forward.append(wp.to_torch(scene["endoscope"].actuators["tip"].linear)[:, 2].tolist())
            roll.append(float(wp.to_torch(scene["endoscope"].actuators["tip"].angular)[0, 2]))
        assert roll[4] == pytest.approx(6.0 * share, rel=1.0e-4)
        rested = [abs(rest - 0.03 * 0.3) < 1.0e-6 for _, rest, _ in forward]
        assert rested == [10 <= step < 10 + times for step in range(20)]
        assert all(never == below > 0.01 for never, _, below in forward)


def test_a_view_circles_around_the_way_while_the_tip_is_pulled_back(scene: InteractiveScene) -> None:
    """Sweep 0.5 rad, turn gain 4, rate 2 rad/s; the way ahead at 0.5 rad from the view, at 0.75 rad, and right ahead.

    At 0.5 rad the view goes around with 2 sin 0.5; at 0.75 rad it also comes nearer by 4 * 0.25 rad/s, about the axis
    from the view to the way; right ahead it leaves by 4 * 0.5 rad/s.
    """
    expert = PullExpert(scene, speed=-0.01, sweep=0.5)
    for angle, expected in ((0.5, (2.0 * math.sin(0.5), 0.0)), (0.75, (2.0 * math.sin(0.75), 1.0)), (0.0, (0.0, -2.0))):
        gaze = torch.tensor([[math.sin(angle), 0.0, math.cos(angle)]] * 3)
        turn = expert._circle(gaze)
        assert turn.tolist() == [pytest.approx((*expected, 0.0), abs=1.0e-6)] * 3


def test_only_a_tip_that_is_pulled_back_looks_around(scene: InteractiveScene) -> None:
    expert = PullExpert(scene, speed=torch.tensor([0.04, 0.04, -0.01]), sweep=0.5)
    expert.act()
    onward, _, back = wp.to_torch(scene["endoscope"].actuators["tip"].angular).norm(dim=1).tolist()
    assert onward < 0.2 < back


def test_a_setting_that_an_expert_does_not_have_is_named(scene: InteractiveScene) -> None:
    with pytest.raises(ValueError, match="PullExpert has no setting 'swep'. Did you mean 'sweep'"):
        make_expert(scene, swep=0.5)
