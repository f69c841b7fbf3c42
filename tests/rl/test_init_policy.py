# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a new run takes over from another run's checkpoint."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg

from arcgym.rl import OnPolicyRunner
from arcgym.utils.errors import UsageError


def make_runner(seed: int, **changes) -> OnPolicyRunner:
    torch.manual_seed(seed)
    return OnPolicyRunner(SteerToDot(4), runner_cfg(**changes).to_dict(), device="cpu")


def same(first: torch.nn.Module, second: torch.nn.Module) -> bool:
    there, here = first.state_dict(), second.state_dict()
    return all(torch.equal(value, here[name]) for name, value in there.items())


@pytest.mark.parametrize("init_critic", [False, True])
def test_the_critic_comes_along_where_it_is_asked_for(tmp_path, init_critic):
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    second = make_runner(seed=1, init_policy=str(tmp_path / "model_0.pt"), init_critic=init_critic)
    second.learn(0)
    assert same(first.alg.actor, second.alg.actor)
    assert same(first.alg.critic, second.alg.critic) == init_critic
    assert second.completed_iterations == 0


def test_a_policy_without_critic_is_named(tmp_path):
    first = make_runner(seed=0)
    torch.save(
        {name: value for name, value in first.alg.save().items() if "critic" not in name} | {"iter": 0, "infos": {}},
        tmp_path / "clone.pt",
    )
    second = make_runner(seed=1, init_policy=str(tmp_path / "clone.pt"), init_critic=True)
    with pytest.raises(UsageError, match="does not fit .*critic_state_dict"):
        second.learn(0)
