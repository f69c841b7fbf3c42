# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.rl import RslRlVecEnvWrapper


def test_constructor_resets_and_reads_sizes(counting_env):
    env = RslRlVecEnvWrapper(counting_env)
    assert (env.num_envs, env.num_actions, env.max_episode_length) == (2, 2, 4)
    assert env.get_observations().batch_size == torch.Size([2])


def test_observations_are_handed_on_without_a_copy(counting_env):
    env = RslRlVecEnvWrapper(counting_env)
    before = env.get_observations()
    after = env.step(torch.zeros(2, 2))[0]
    assert before["policy"].max() == 0 and after["policy"].min() == 1
    assert after["policy"].data_ptr() == counting_env.image.data_ptr()


def test_images_stay_bytes(counting_env):
    assert RslRlVecEnvWrapper(counting_env).get_observations()["policy"].dtype == torch.uint8


def test_actions_are_clipped(counting_env):
    env = RslRlVecEnvWrapper(counting_env, clip_actions=1.0)
    _, rewards, _, _ = env.step(torch.tensor([[3.0, 0.0], [-0.5, 0.0]]))
    assert rewards.tolist() == [1.0, -0.5]


def test_truncation_is_a_time_out_and_a_done(counting_env):
    env = RslRlVecEnvWrapper(counting_env)
    env.episode_length_buf = torch.tensor([3, 0])
    _, _, dones, extras = env.step(torch.zeros(2, 2))
    assert dones.tolist() == [1, 0]
    assert dones.dtype == torch.long
    assert extras["time_outs"].tolist() == [True, False]


def test_means_over_worlds_that_end_count_as_often_as_these(counting_env, monkeypatch) -> None:
    """One success alone, then three failures together: rsl_rl's mean over the steps is 1 of 4, not a half."""
    env, seen = RslRlVecEnvWrapper(counting_env), []
    for success, ended in ((1.0, 1), (0.0, 3)):
        log = {"Episode_Metrics/success": torch.tensor(success), "Episode_Termination/success": torch.tensor(success)}
        step = counting_env._obs(), torch.zeros(2), *[torch.zeros(2, dtype=torch.bool)] * 2, {"log": log}
        monkeypatch.setattr(counting_env, "step", lambda actions, step=step: step)
        counting_env.num_done = ended
        log = env.step(torch.zeros(2, 2))[3]["log"]
        seen.append(log["Episode_Metrics/success"])
        assert log["Episode_Termination/success"].shape == ()
    assert torch.cat(seen).mean().item() == 0.25


def test_finite_horizon_has_no_time_outs(counting_env):
    counting_env.cfg.is_finite_horizon = True
    extras = RslRlVecEnvWrapper(counting_env).step(torch.zeros(2, 2))[3]
    assert "time_outs" not in extras
    assert set(extras) == {"log", "cost"}


def test_nested_group_is_named(counting_env, monkeypatch):
    monkeypatch.setattr(counting_env, "reset", lambda: ({"policy": {"rgb": torch.zeros(2, 1)}}, {}))
    with pytest.raises(TypeError, match="'policy' is a dict.*concatenate_terms"):
        RslRlVecEnvWrapper(counting_env)
