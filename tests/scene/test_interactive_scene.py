# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scene with a sensor that counts how often each world is read."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import torch
from tiny_sim import TinySim

from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.scene import InteractiveScene, InteractiveSceneCfg
from arcgym.sensors import SensorBase
from arcgym.sim import SimulationCfg
from arcgym.utils import configclass


class Counter(SensorBase):
    """Counts its readings, world by world."""

    def initialize(self, scene: InteractiveScene) -> None:
        self.readings = torch.zeros(scene.num_envs, dtype=torch.long)
        self.scene = scene

    @property
    def data(self) -> Any:
        return SimpleNamespace(readings=self.readings)

    def update(self, env_mask: torch.Tensor | None = None) -> None:
        self.readings[slice(None) if env_mask is None else env_mask] += 1

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        self.readings[slice(None) if env_ids is None else env_ids] = 0


@configclass
class CounterCfg:
    class_type: Any = Counter
    update_period: float = 0.2


@configclass
class CountedSceneCfg(InteractiveSceneCfg):
    counter: CounterCfg = CounterCfg()


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("scene"))


@pytest.fixture
def scene(tiny: TinySim) -> InteractiveScene:
    cfg = CountedSceneCfg(num_envs=3, colon=tiny.colon_cfg(), endoscope=tiny.scope_cfg("capsule"))
    return InteractiveScene(cfg, SimulationCfg())


def test_assets_and_sensors_are_found_by_name(scene: InteractiveScene) -> None:
    assert scene.keys() == ["colon", "endoscope", "counter"]
    assert isinstance(scene["colon"], Colon) and isinstance(scene["endoscope"], Endoscope)
    assert scene["counter"].scene is scene
    assert scene["colon"] is scene.sim.colon


def test_an_unknown_name_gets_a_suggestion(scene: InteractiveScene) -> None:
    with pytest.raises(KeyError, match="no 'endoscop'.*endoscope"):
        scene["endoscop"]


def test_a_sensor_set_to_none_is_left_out(tiny: TinySim) -> None:
    cfg = CountedSceneCfg(num_envs=1, colon=tiny.colon_cfg(), endoscope=tiny.scope_cfg("capsule"))
    cfg.counter = None
    assert InteractiveScene(cfg, SimulationCfg()).keys() == ["colon", "endoscope"]


def test_worlds_share_the_origin(scene: InteractiveScene) -> None:
    assert scene.num_envs == 3 and scene.device == "cpu"
    assert torch.equal(scene.env_origins, torch.zeros(3, 3))


def test_sensors_are_read_once_their_period_is_over(scene: InteractiveScene) -> None:
    counts = []
    for _ in range(4):
        scene.update(0.1)
        counts.append(scene["counter"].data.readings.tolist())
    assert counts == [[0] * 3, [1] * 3, [1] * 3, [2] * 3]


def test_update_with_a_mask_reads_those_worlds(scene: InteractiveScene) -> None:
    scene.update(0.0, torch.tensor([True, False, True]))
    assert scene["counter"].data.readings.tolist() == [1, 0, 1]


def test_update_without_time_reads_all_worlds(scene: InteractiveScene) -> None:
    scene.update(0.0)
    assert scene["counter"].data.readings.tolist() == [1, 1, 1]


def test_reset_reaches_the_sensors(scene: InteractiveScene) -> None:
    scene.update(0.0)
    scene.reset(torch.tensor([1]))
    assert scene["counter"].data.readings.tolist() == [1, 0, 1]


def test_a_missing_stage_is_named_before_anything_is_built(tiny: TinySim) -> None:
    cfg = InteractiveSceneCfg(num_envs=1, colon=tiny.colon_cfg(), endoscope=tiny.scope_cfg("capsule"))
    cfg.colon.usd_path = str(tiny.folder / "none.usda")
    with pytest.raises(Exception, match="none.usda"):
        InteractiveScene(cfg, SimulationCfg(device="cuda:99"))
