# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An environment that is brought back makes the same steps again, to the last bit of every manager."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.envs import mdp
from arcgym.envs.memory import EnvMemory
from arcgym.managers import GaussianNoiseCfg, ManagerTermBase, MetricsTermCfg, RewardTermCfg
from arcgym.utils.registry import load_cfg_from_registry


class way_made(ManagerTermBase):
    """A term of the test's own with a memory: how far the tip came since the last step."""

    def __init__(self, cfg: Any, env: Any) -> None:
        super().__init__(cfg, env)
        self.before: Any = None
        self.seen: list[float] = []

    def __call__(self, env: Any) -> torch.Tensor:
        now = env.scene["endoscope"].data.tip_pos_w.clone()
        made = torch.zeros(env.num_envs) if self.before is None else (now - self.before).norm(dim=1)
        self.before = now
        self.seen.append(float(made[0]))
        return made + 0.01 * len(self.seen)


@pytest.fixture(scope="module", params=["Capsule", "Proximal"])
def env(request, tiny_colon_path) -> Any:
    cfg = load_cfg_from_registry(f"ARC-Splenic-{request.param}", "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path, cfg.start, cfg.seed = 2, str(tiny_colon_path), "rest", 1
    cfg.scene.camera.width = cfg.scene.camera.height = 36
    cfg.sim.device = "cpu"
    cfg.metrics.seen = MetricsTermCfg(func=mdp.coverage, reduce="last")
    cfg.rewards.way = RewardTermCfg(func=way_made, weight=1.0)
    cfg.observations.critic.velocity.noise = GaussianNoiseCfg(std=0.1)
    env = gym.make(f"ARC-Splenic-{request.param}", cfg=cfg).unwrapped
    env.reset()
    return env


def steps(env: Any, actions: torch.Tensor) -> list[torch.Tensor]:
    """Everything that steps give and leave behind."""
    seen: list[torch.Tensor] = []
    for action in actions:
        obs, reward, terminated, truncated, _ = env.step(action)
        seen += [*obs.values(), reward, terminated, truncated, env.episode_length_buf]
        seen += [env.metrics_manager.get_value(name) for name in env.metrics_manager.active_terms]
        seen += [*env.sim.world_arrays().values(), env.scene["camera"].data.output["rgb"]]
        seen = [value.clone() for value in seen]
    return seen


def test_brought_back_twice_it_does_the_same(env) -> None:
    torch.manual_seed(4)
    actions = 2.0 * torch.rand(14, 2, env.action_manager.total_action_dim) - 1.0
    steps(env, actions[:5])
    memory = EnvMemory(env)
    first = steps(env, actions[5:])
    for _ in range(2):
        memory.restore()
        assert all(torch.equal(a, b) for a, b in zip(first, steps(env, actions[5:]), strict=True))
    memory.restore()
    other = steps(env, -actions[5:])
    assert sum(not torch.equal(a, b) for a, b in zip(first, other, strict=True)) > 10
