# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import math
from types import SimpleNamespace

import torch

from arcgym.rl import RslRlVecEnvWrapper, describe_rollout, rollout_bytes
from arcgym.rl.rollout import run_policy, zero_policy


def wrap(env, success: list[bool] | None = None) -> RslRlVecEnvWrapper:
    succeeds = torch.tensor(success or [False, False])
    env.termination_manager = SimpleNamespace(
        active_terms=["arrived"],
        get_term=lambda name: succeeds,
        get_term_cfg=lambda name: SimpleNamespace(success=True, time_out=False),
    )
    env.succeeded, env.failed = succeeds, torch.zeros(2, dtype=torch.bool)
    env.step_dt = 0.5
    env.metrics_manager = SimpleNamespace(active_terms=["progress"], finished={"progress": torch.tensor([0.25, 0.75])})
    return RslRlVecEnvWrapper(env)


def end_at(env, *steps: tuple[int, int]) -> None:
    """Make worlds of ``env`` end their episode at some steps, (step, world), and at no other."""
    env.max_episode_length, original = 100, env.step

    def stepped(action):
        obs, rewards, terminated, truncated, extras = original(action)
        for step, world in steps:
            terminated[world] |= step == env.common_step_counter
        return obs, rewards, terminated, truncated, extras

    env.step = stepped


def test_rewards_and_episodes_are_counted(counting_env):
    """Two worlds earn 1 and 3 a step; episodes of 4 steps end once each in 6 steps."""
    actions = torch.tensor([[1.0, 0.0], [3.0, 0.0]])
    result = run_policy(wrap(counting_env, success=[True, False]), lambda obs: actions, steps=6)
    assert result.reward_per_step == 2.0
    assert result.episodes == 2
    assert result.reward_per_episode == (4 * 1.0 + 4 * 3.0) / 2
    assert result.success_rate == 0.5


def test_only_the_first_episode_of_a_world_counts(counting_env):
    """World 0 succeeds after 2 steps, and would again after 4; world 1 fails after 5."""
    end_at(counting_env, (2, 0), (4, 0), (5, 1))
    actions = torch.tensor([[1.0, 0.0], [3.0, 0.0]])
    result = run_policy(wrap(counting_env, success=[True, False]), lambda obs: actions)
    assert result.steps == 5
    assert result.episodes == result.num_envs == 2
    assert result.success_rate == 0.5
    assert result.reward_per_episode == (2 * 1.0 + 5 * 3.0) / 2
    assert result.metrics == {"Episode_Metrics/progress": (0.25 + 0.75) / 2}
    assert result.first_episodes == [
        {"world": 0, "success": 1, "end": "arrived", "reward": 2.0, "seconds": 1.0, "progress": 0.25},
        {"world": 1, "success": 0, "end": "non_finite", "reward": 15.0, "seconds": 2.5, "progress": 0.75},
    ]


def test_a_world_that_breaks_ends_by_that_whatever_else_it_did(counting_env):
    """Both worlds arrive after 2 steps, and world 1 breaks: what a term says of a broken state is not believed."""
    end_at(counting_env, (2, 0), (2, 1))
    env = wrap(counting_env, success=[True, True])
    counting_env.succeeded, counting_env.failed = torch.tensor([True, False]), torch.tensor([False, True])
    rows = run_policy(env, zero_policy(env)).first_episodes
    assert [(row["success"], row["end"]) for row in rows] == [(1, "arrived"), (0, "non_finite")]


def test_worlds_that_have_not_ended_are_named(counting_env):
    end_at(counting_env, (2, 0))
    result = run_policy(wrap(counting_env, success=[True, True]), lambda obs: torch.zeros(2, 2), steps=3)
    assert result.success_rate == 1.0
    assert "first episode of 1 of 2 worlds ended" in str(result)


def test_no_ended_episode_has_no_success_rate(counting_env):
    env = wrap(counting_env)
    result = run_policy(env, zero_policy(env), steps=2)
    assert math.isnan(result.success_rate)
    assert "no episode ended" in str(result)


def test_rollout_memory(counting_env):
    """2 worlds x 5 steps x (1200 bytes of image + 4 of state + 4 x (3 x 2 of actions, means, deviations + 6))."""
    obs = RslRlVecEnvWrapper(counting_env).get_observations()
    assert rollout_bytes(obs, num_actions=2, num_steps=5) == 2 * 5 * (1200 + 4 + 4 * 12)
    assert "2 worlds x 5 steps" in describe_rollout(obs, 2, 5)


def test_memory_is_cleared_where_episodes_end(counting_env):
    """Episodes of 4 steps: in 6 steps the policy hears of ends once, in the fourth."""
    heard = []

    class Policy:
        def __call__(self, obs):
            return torch.zeros(2, 2)

        def reset(self, dones):
            heard.append(dones.tolist())

    run_policy(wrap(counting_env), Policy(), steps=6)
    assert heard == [[0, 0]] * 3 + [[1, 1]] + [[0, 0]] * 2
