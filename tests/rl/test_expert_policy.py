# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Commands of experts as actions, in the tiny colon."""

from __future__ import annotations

import gymnasium as gym
import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.rl.expert_policy import ExpertPolicy
from arcgym.utils.registry import load_cfg_from_registry


def make(robot: str, colon) -> gym.Env:
    cfg = load_cfg_from_registry(f"ARC-Splenic-{robot}", "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path, cfg.start, cfg.seed = 1, str(colon), "rest", 0
    cfg.scene.camera.width = cfg.scene.camera.height = 36
    cfg.events.aim, cfg.sim.device = None, "cpu"
    return gym.make(f"ARC-Splenic-{robot}", cfg=cfg).unwrapped


@pytest.fixture(scope="module")
def pushed(tiny_colon_path) -> gym.Env:
    env = make("Proximal", tiny_colon_path)
    env.reset()
    return env


def test_actions_command_what_the_expert_commanded(pushed) -> None:
    scope = pushed.scene["endoscope"]
    scope.set_insertion_command(torch.tensor([0.02]), torch.tensor([-0.5]))
    scope.set_bending_command(scope.data.bending[:, 0] + 0.065, scope.data.bending[:, 1] - 3.0)
    # insertion 0.05 m/s, roll 1 rad/s, bending 1.3 rad/s and 0.13 rad a step at an action of one
    torch.testing.assert_close(pushed.action_manager.commanded_actions(), torch.tensor([[0.4, -0.5, 0.5, -1.0]]))


def test_pulled_tip(tiny_colon_path) -> None:
    env = make("Capsule", tiny_colon_path)
    env.reset()
    linear, angular = torch.tensor([[0.0, -0.025, 0.1]]), torch.tensor([[0.3, 0.0, -0.75]])
    env.scene["endoscope"].set_tip_velocity_command(linear, angular)
    # 0.05 m/s and 1.5 rad/s at an action of one
    expected = torch.tensor([[0.0, -0.5, 1.0, 0.2, 0.0, -0.5]])
    torch.testing.assert_close(env.action_manager.commanded_actions(), expected)
    policy = ExpertPolicy(env)
    start = env.scene["endoscope"].data.tip_arc_length.clone()
    for _ in range(12):
        env.step(policy())
    assert env.scene["endoscope"].data.tip_arc_length - start > 0.03
    assert float(policy.expert.memory()[0]) > 0.0
    policy.reset(torch.tensor([1]))
    assert float(policy.expert.memory()[0]) == -1.0


def test_pushed_scope_gets_on(pushed) -> None:
    policy = ExpertPolicy(pushed, speed=0.05)
    start = pushed.scene["endoscope"].data.tip_arc_length.clone()
    for _ in range(12):
        pushed.step(policy())
    assert pushed.scene["endoscope"].data.tip_arc_length - start > 0.03


def test_experts_draw_from_the_episodes_random_numbers(pushed) -> None:
    """What an expert draws follows from the episode's seed and the step, not from what was drawn before."""
    expert = ExpertPolicy(pushed).expert
    first = expert.normal("side", 3)
    torch.manual_seed(0)
    assert torch.equal(expert.normal("side", 3), first) and first.shape == (1, 3)
    pushed.random.advance()
    assert not torch.equal(expert.normal("side", 3), first)
    assert 0.0 <= float(expert.uniform("turn")) < 1.0
