# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scene that a reader can follow by hand: each world is a number that grows by its action every physics step."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import torch

from arcgym.envs import ManagerBasedRLEnv, ManagerBasedRLEnvCfg
from arcgym.managers import (
    ActionTerm,
    ActionTermCfg,
    EventTermCfg,
    ObservationGroupCfg,
    ObservationTermCfg,
    RewardTermCfg,
    TerminationTermCfg,
)
from arcgym.sim import SimulationCfg
from arcgym.utils import configclass


class Counter:
    """The only asset: a position per world."""

    def __init__(self, num_envs: int) -> None:
        self.position = torch.zeros(num_envs)
        self.velocity = torch.zeros(num_envs)


class CounterSim:
    def __init__(self, counter: Counter, num_envs: int) -> None:
        self.counter = counter
        self.num_forwards = 0
        self.shortage: str | None = None
        self.contact = SimpleNamespace(shortage=lambda: self.shortage)
        self._num_envs = num_envs

    @property
    def non_finite(self) -> torch.Tensor:
        return ~torch.isfinite(self.counter.position)

    def step(self, n: int) -> None:
        self.counter.position += n * self.counter.velocity

    def forward(self, env_mask: object = None) -> None:
        self.num_forwards += 1


class CounterScene:
    """Stands in for InteractiveScene; its camera draws a small image filled with the position."""

    def __init__(self, cfg: CounterSceneCfg, sim_cfg: Any) -> None:
        self.cfg = cfg
        self.num_envs = cfg.num_envs
        self.device = "cpu"
        self.counter = Counter(cfg.num_envs)
        self.sim = CounterSim(self.counter, cfg.num_envs)
        self.image = torch.zeros(cfg.num_envs, 3, cfg.image_size, cfg.image_size, dtype=torch.uint8)
        self.seed_at_build = torch.initial_seed()
        self.drawn: list[list[int]] = []

    def keys(self) -> list[str]:
        return ["counter"]

    def __getitem__(self, name: str) -> Counter:
        return {"counter": self.counter}[name]

    def reset(self, env_ids: torch.Tensor) -> None:
        self.counter.velocity[env_ids] = 0.0

    def update(self, dt: float, env_mask: torch.Tensor | None = None) -> None:
        mask = torch.ones(self.num_envs, dtype=torch.bool) if env_mask is None else env_mask
        value = torch.nan_to_num(self.counter.position).to(torch.uint8).view(-1, 1, 1, 1)
        self.image = torch.where(mask.view(-1, 1, 1, 1), value.expand_as(self.image), self.image)
        self.drawn.append(mask.nonzero().flatten().tolist())


@configclass
class CounterSceneCfg:
    class_type: type = CounterScene
    num_envs: int = 2
    image_size: int = 2


class VelocityAction(ActionTerm):
    def __init__(self, cfg: ActionTermCfg, env: ManagerBasedRLEnv) -> None:
        super().__init__(cfg, env)
        self._raw = torch.zeros(env.num_envs, 1)

    @property
    def action_dim(self) -> int:
        return 1

    @property
    def raw_actions(self) -> torch.Tensor:
        return self._raw

    @property
    def processed_actions(self) -> torch.Tensor:
        return self._raw

    def process_actions(self, actions: torch.Tensor) -> None:
        self._raw = actions.clone()

    def apply_actions(self) -> None:
        self._asset.velocity = self._raw[:, 0].clone()


def position(env: ManagerBasedRLEnv) -> torch.Tensor:
    return env.scene["counter"].position


def position_column(env: ManagerBasedRLEnv) -> torch.Tensor:
    return position(env).unsqueeze(1)


def image(env: ManagerBasedRLEnv) -> torch.Tensor:
    return env.scene.image


def last_action(env: ManagerBasedRLEnv) -> torch.Tensor:
    return env.action_manager.action


def above(env: ManagerBasedRLEnv, limit: float) -> torch.Tensor:
    return position(env) > limit


def time_out(env: ManagerBasedRLEnv) -> torch.Tensor:
    return env.episode_length_buf >= env.max_episode_length


def to_start(env: ManagerBasedRLEnv, env_ids: torch.Tensor, start: float = 0.0) -> None:
    position(env)[env_ids] = start


@configclass
class CounterObservationsCfg:
    @configclass
    class PolicyCfg(ObservationGroupCfg):
        rgb = ObservationTermCfg(func=image, history_length=3)

    @configclass
    class CriticCfg(ObservationGroupCfg):
        position = ObservationTermCfg(func=position_column)
        action = ObservationTermCfg(func=last_action)

    policy: PolicyCfg = PolicyCfg()
    critic: CriticCfg = CriticCfg()


@configclass
class CounterSimCfg(SimulationCfg):
    dt: float = 0.05

    def validate_config(self) -> None:
        """A counter takes steps of any length."""


@configclass
class CounterEnvCfg(ManagerBasedRLEnvCfg):
    """Two physics steps of 0.05 s make a control step of 0.1 s; an episode has 5 of them."""

    scene: CounterSceneCfg = CounterSceneCfg()
    observations = CounterObservationsCfg()
    actions = {"velocity": ActionTermCfg(class_type=VelocityAction, asset_name="counter")}
    events = {"start": EventTermCfg(func=to_start, mode="reset")}
    rewards = {"position": RewardTermCfg(func=position, weight=2.0)}
    terminations = {
        "time_out": TerminationTermCfg(func=time_out, time_out=True),
        "above": TerminationTermCfg(func=above, params={"limit": 7.0}),
    }
    decimation: int = 2
    episode_length_s: float = 0.5
    seed: int | None = 0
    sim: SimulationCfg = CounterSimCfg()


@pytest.fixture
def cfg() -> CounterEnvCfg:
    return CounterEnvCfg()


@pytest.fixture
def env(cfg: CounterEnvCfg) -> ManagerBasedRLEnv:
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    return env
