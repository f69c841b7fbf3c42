# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a step has the host do once it knows which worlds are done: with many worlds nearly every step resets some."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode

import arcgym_tasks  # noqa: F401
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Splenic-Proximal"


class Operations(TorchDispatchMode):
    """Counts torch's operations but for those that make views or empty memory."""

    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        makes_view = any(returned.alias_info and not returned.alias_info.is_write for returned in func._schema.returns)
        self.count += not makes_view and not func._schema.name.startswith("aten::empty")
        return func(*args, **(kwargs or {}))


def make(colon: Any, device: str) -> Any:
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path, cfg.start, cfg.seed = 3, str(colon), "rest", 1
    cfg.scene.camera.width = cfg.scene.camera.height = 36
    cfg.sim.device = device
    env = gym.make(TASK, cfg=cfg).unwrapped
    env.reset()
    for _ in range(3):
        env.step(torch.zeros(3, 4, device=device))
    return env


def test_a_reset_is_few_operations(tiny_colon_path) -> None:
    env = make(tiny_colon_path, "cpu")
    with Operations() as operations:
        env._start(torch.tensor([0, 2]), torch.tensor([True, False, True]))
    assert 50 < operations.count < 115


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs CUDA")
def test_a_step_with_a_reset_waits_for_nothing_but_the_worlds_that_are_done(tiny_colon_path) -> None:
    env, before = make(tiny_colon_path, "cuda:0"), torch.cuda.get_sync_debug_mode()
    action = torch.zeros(3, 4, device="cuda:0")
    for steps in ([0, 1, 10**6], [10**6, 0, 10**6]):
        env.episode_length_buf = torch.tensor(steps, device="cuda:0")
        torch.cuda.set_sync_debug_mode("error")
        try:
            truncated = env.step(action)[3]
        finally:
            torch.cuda.set_sync_debug_mode(before)
        assert truncated.tolist() == [count > 1 for count in steps]
