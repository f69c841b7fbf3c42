# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import gymnasium as gym
import pytest
import torch

from arcgym.rl import OnPolicyRunner, RslRlVecEnvWrapper
from arcgym.utils.registry import list_tasks, load_cfg_from_registry


def distinct_agents() -> list[str]:
    """One task for each agent configuration that is registered."""
    tasks = {gym.registry[task].kwargs.get("rsl_rl_cfg_entry_point"): task for task in list_tasks()}
    return sorted(task for entry_point, task in tasks.items() if entry_point)


@pytest.mark.parametrize("task", distinct_agents())
def test_agent_builds_and_acts(task, counting_env):
    counting_env.image = torch.zeros(2, 15, 84, 84, dtype=torch.uint8)
    env = RslRlVecEnvWrapper(counting_env)
    cfg = load_cfg_from_registry(task, "rsl_rl_cfg_entry_point")
    runner = OnPolicyRunner(env, cfg.replace(num_steps_per_env=2).to_dict(), device="cpu")
    assert runner.alg.act(env.get_observations()).shape == (2, 2)
