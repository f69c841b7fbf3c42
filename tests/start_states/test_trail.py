# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""States on the way, from which worlds try again: a capsule in a straight tube, four worlds."""

from __future__ import annotations

from pathlib import Path

import torch
from tiny_sim import TinySim

from arcgym.experts import PullExpert
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg
from arcgym.start_states.trail import REACH, SPACING, Trail
from arcgym.start_states.world_pool import MOST_NEAR, NEAR, WorldPool


def scene_of(folder: Path, worlds: int = 4) -> InteractiveScene:
    tube = TinySim(folder)
    cfg = InteractiveSceneCfg(num_envs=worlds, colon=tube.colon_cfg(rigid=True), endoscope=tube.scope_cfg("capsule"))
    return InteractiveScene(cfg, SimulationCfg())


def test_a_world_goes_on_from_where_another_one_was(tmp_path: Path) -> None:
    scene = scene_of(tmp_path)
    data, remembered = scene["endoscope"].data, torch.arange(4.0)
    trail = Trail(scene.sim, 1, lambda: [remembered])
    trail.follow(0, float(data.tip_arc_length[2]), 2)
    first, pose = data.tip_arc_length.clone(), data.joint_pos[2].clone()
    velocity = torch.zeros(4, 3)
    velocity[:, 2] = 0.05
    scene["endoscope"].set_tip_velocity_command(velocity, torch.zeros(4, 3))
    scene.sim.step(96)
    later = data.tip_arc_length.clone()
    assert (later > first + 0.004).all()
    assert trail.put_back([1, 3], [0, 0], [0.0, 1.0], [0.5, 0.5]) == [1]  # no state is 1 m far
    assert torch.equal(data.joint_pos[1], pose)
    assert torch.equal(data.tip_arc_length[[0, 2, 3]], later[[0, 2, 3]])
    assert remembered.tolist() == [0.0, 2.0, 2.0, 3.0]


def test_states_are_a_few_centimeters_apart_and_not_kept_for_ever(tmp_path: Path) -> None:
    trail = Trail(scene_of(tmp_path).sim, 1, lambda: [])
    for arc in (0.10, 0.10 + 0.5 * SPACING, 0.10 + SPACING, 0.11 + REACH):
        trail.follow(0, arc, 0)
    assert [place.arc for place in trail.places[0]] == [0.10 + SPACING, 0.11 + REACH]


def test_worlds_beside_a_foremost_that_is_stuck_try_again(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, 16)
    population = WorldPool(scene, PullExpert(scene))
    arc = torch.full((16,), 0.50)
    arc[:4] = 0.51
    for _ in range(3):  # 3, 6 and 9 cm behind are allowed
        population.exchange(arc, arc)
        assert len(population.tries_again(arc)[0]) == 0
    for _ in range(20):
        population.exchange(arc, arc)
    worlds, back = population.tries_again(arc)
    assert 0 < len(worlds) < 12 and worlds.min() >= 4  # about half of the twelve that are not of the foremost quarter
    assert torch.allclose(back, torch.tensor(MOST_NEAR)) and MOST_NEAR > NEAR
    arc[7] = 0.60
    population.exchange(arc, arc)
    assert len(population.tries_again(arc)[0]) == 0  # one got on
