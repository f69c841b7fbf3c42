# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Every registered task builds on the real colon, resets to its start and steps."""

from __future__ import annotations

import gymnasium as gym
import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.utils.registry import list_tasks, load_cfg_from_registry

QUICK = {"ARC-Descending-Capsule", "ARC-Sigmoid-Magnetic-Play", "ARC-Splenic-Proximal"}
"""One task a robot; the others take minutes together."""

TASKS = [task if task in QUICK else pytest.param(task, marks=pytest.mark.slow) for task in list_tasks()]


@pytest.mark.parametrize("task", TASKS)
def test_task_builds_and_steps(task: str) -> None:
    cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.seed = 1, 7
    env = gym.make(task, cfg=cfg).unwrapped
    observations, _ = env.reset()
    start = env.scene["colon"].stage.segment_bounds()[cfg.segment][0] if cfg.start == "segment" else 0.0
    assert float(env.scene["endoscope"].data.tip_arc_length[0]) == pytest.approx(start, abs=0.03)
    for _ in range(2):
        action = torch.zeros(1, env.action_manager.total_action_dim)
        observations, reward, terminated, truncated, _ = env.step(action)
    assert observations["policy"].shape == (1, 15, 84, 84)
    assert observations["policy"].float().std() > 1.0
    assert torch.isfinite(reward).all() and torch.isfinite(observations["critic"]).all()
    assert not terminated.any() and not truncated.any()
    env.close()
