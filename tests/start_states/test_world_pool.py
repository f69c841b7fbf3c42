# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds of a patient that work together: four worlds of each of two tubes."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch
from tiny import write_tiny_colon
from tiny_sim import TinySim

from arcgym.experts import PullExpert
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg
from arcgym.start_states import world_pool as module
from arcgym.start_states.world_pool import WorldPool


@pytest.fixture(autouse=True)
def all_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every world draw all settings."""
    monkeypatch.setattr(module, "PLAIN", 0.0)


def scene_of(folder: Path, worlds: int) -> InteractiveScene:
    tube, paths = TinySim(folder), []
    for name, length in (("short", 0.20), ("long", 0.22)):
        (folder / name).mkdir()
        paths.append(str(write_tiny_colon(folder / name, length=length)))
    cfg = InteractiveSceneCfg(
        num_envs=worlds, colon=tube.colon_cfg(usd_path=paths, rigid=True), endoscope=tube.scope_cfg("capsule")
    )
    return InteractiveScene(cfg, SimulationCfg())


def test_those_behind_go_on_from_the_foremost_of_their_patient(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 8)
    expert = PullExpert(scene)
    pool = WorldPool(scene, expert)
    assert expert.speed[:2].tolist() == pytest.approx([0.04] * 2) and len(set(expert.speed.tolist())) == 7
    velocity = torch.zeros(8, 3)
    velocity[:, 2] = torch.linspace(0.02, 0.06, 8)
    for _ in range(2):
        scene["endoscope"].set_tip_velocity_command(velocity, torch.zeros(8, 3))
        scene.sim.step(48)
    before, speed = scene["endoscope"].data.joint_pos.clone(), expert.speed.clone()
    arc = scene["endoscope"].data.tip_arc_length.clone()
    moved, sources = pool.exchange(arc, 10.0 * arc)
    assert sorted(zip(moved.tolist(), sources.tolist(), strict=True)) == [(0, 6), (1, 7), (2, 6), (3, 7)]
    now = scene["endoscope"].data.joint_pos
    assert torch.equal(now[:4], before[[6, 7, 6, 7]]) and torch.equal(now[4:], before[4:])
    assert torch.equal(scene["endoscope"].data.tip_arc_length[:4], arc[[6, 7, 6, 7]])
    assert torch.equal(expert.speed[4:], speed[4:]) and not torch.isclose(expert.speed[:4], speed[:4]).any()


def test_those_hardly_behind_keep_their_states_and_some_get_new_settings(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 8)
    expert = PullExpert(scene)
    pool = WorldPool(scene, expert)
    before, speed = scene["endoscope"].data.joint_pos.clone(), expert.speed.clone()
    arc = torch.tensor([0.50, 0.50, 0.40, 0.50, 0.51, 0.51, 0.52, 0.52])
    score = arc - torch.tensor([0.10, 0.10, 0.10, 0.10, 0.0, 0.0, 0.0, 0.0])
    moved, sources = pool.exchange(score, arc)  # world 2 alone is 12 cm behind; the others have more in loops
    assert (moved.tolist(), sources.tolist()) == ([2], [6])
    now = scene["endoscope"].data.joint_pos
    assert torch.equal(now[[0, 1, 3]], before[[0, 1, 3]])
    assert torch.equal(expert.speed[4:], speed[4:]) and not torch.isclose(expert.speed[2], speed[2])
    renewed = 0
    arc[2] = 0.50
    for _ in range(40):  # four worlds that are hardly behind: a quarter of 160
        speed = expert.speed.clone()
        assert len(pool.exchange(score, arc)[0]) == 0
        renewed += int((expert.speed[:4] != speed[:4]).sum())
    assert torch.equal(expert.speed[4:], speed[4:]) and 20 <= renewed <= 60


def test_worlds_of_a_patient_that_needs_none_help_the_others(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 8)
    pool = WorldPool(scene, PullExpert(scene))
    velocity = torch.zeros(8, 3)
    velocity[:, 2] = torch.linspace(0.02, 0.06, 8)
    for _ in range(2):
        scene["endoscope"].set_tip_velocity_command(velocity, torch.zeros(8, 3))
        scene.sim.step(48)
    arc = scene["endoscope"].data.tip_arc_length.clone()
    moved, sources = pool.hand_over([0], arc)  # world 7 is the foremost of the second patient
    assert (moved.tolist(), sources.tolist()) == ([0, 2, 4, 6], [7, 7, 7, 7])
    assert pool.owner.tolist() == [1] * 8 and scene.colon.data.patient.tolist() == [1] * 8
    assert torch.equal(scene["endoscope"].data.tip_arc_length[[0, 2, 4, 6]], arc[[7, 7, 7, 7]])
    ranking = pool.rank(arc)
    assert ranking.counts.tolist() == [0, 8] and ranking.order.tolist() == [7, 6, 5, 4, 3, 2, 1, 0]
    assert len(pool.hand_over([0], arc)[0]) == 0 and len(pool.hand_over([0, 1], arc)[0]) == 0


def test_the_longer_the_foremost_is_stuck_the_farther_behind_others_may_be(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 8)
    pool = WorldPool(scene, PullExpert(scene))
    arc = torch.tensor([0.45, 0.47, 0.50, 0.50, 0.51, 0.51, 0.52, 0.52])  # 7 cm behind and 5 cm behind, in that order
    assert sorted(pool.exchange(arc, arc)[0].tolist()) == [0, 1]
    assert sorted(pool.exchange(arc, arc)[0].tolist()) == [0]  # 6 cm are allowed now
    assert len(pool.exchange(arc, arc)[0]) == 0  # 9 cm
    assert sorted(pool.exchange(arc, arc + 0.02)[0].tolist()) == [0, 1]  # it got on: 3 cm


def test_the_first_world_of_a_patient_is_not_disturbed(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 4)
    expert = PullExpert(scene)
    pool = WorldPool(scene, expert)
    pool.disturb()
    assert not expert.disturbance[:2].any() and expert.disturbance[2:].all()


def test_some_worlds_vary_only_in_how_they_roll(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PLAIN", 0.5)
    scene = scene_of(tmp_path, 80)
    expert = PullExpert(scene, speed=0.05)
    pool = WorldPool(scene, expert)
    pool.disturb()
    plain = expert.speed == 0.05
    assert 25 <= int(plain[2:].sum()) <= 53  # half of 78, give or take three deviations
    assert torch.equal(expert.disturbance.any(dim=1), ~plain)
    assert (expert.look[plain] == 0.02).all() and (expert.look[~plain] != 0.02).all()
    assert (expert.roll[:2] == 0.0).all() and (expert.roll[2:][plain[2:]] >= 6.0).all()


def test_patients_have_as_many_worlds_each(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 3)
    with pytest.raises(ValueError, match="3 worlds cannot be shared out evenly among 2 patients"):
        WorldPool(scene, PullExpert(scene))
