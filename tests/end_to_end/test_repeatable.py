# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The whole environment on the real colon repeats itself, bit for bit, on the CPU."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Sigmoid-Capsule"


def make_env() -> Any:
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.seed = 2, 3
    return gym.make(TASK, cfg=cfg).unwrapped


def rollout(env: Any, steps: int = 4) -> list[torch.Tensor]:
    """Observations and rewards from a seeded reset on, under fixed actions."""
    observations, _ = env.reset(seed=5)
    seen = [*observations.values()]
    actions = torch.linspace(-1.0, 1.0, steps * 2 * env.action_manager.total_action_dim).view(steps, 2, -1)
    for action in actions:
        observations, reward, *_ = env.step(action)
        seen += [*observations.values(), reward]
    return seen


@pytest.fixture(scope="module")
def first() -> tuple[Any, list[torch.Tensor]]:
    env = make_env()
    return env, rollout(env)


def test_a_fresh_environment_makes_the_same_rollout(first: tuple[Any, list[torch.Tensor]]) -> None:
    assert all(torch.equal(a, b) for a, b in zip(first[1], rollout(make_env()), strict=True))


def test_a_reset_environment_makes_the_same_rollout(first: tuple[Any, list[torch.Tensor]]) -> None:
    env, seen = first
    assert all(torch.equal(a, b) for a, b in zip(seen, rollout(env), strict=True))
