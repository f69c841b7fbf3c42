# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The same seed gives the same weights, run after run."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import ENCODER, actor_cfg, runner_cfg
from test_ppo_lagrangian import make_runner as make_lagrangian_runner
from test_sac import make_runner as make_sac_runner

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg, RecurrentCnnModelCfg
from arcgym.utils.threads import one_thread


def make_on_policy_runner(**changes) -> OnPolicyRunner:
    torch.manual_seed(0)
    return OnPolicyRunner(SteerToDot(8), runner_cfg(**changes).to_dict(), device="cpu")


def image_actor(kind: type, **settings):
    return kind(hidden_dims=[16], cnn_cfg=ENCODER, distribution_cfg=GaussianDistributionCfg(), **settings)


RUNNERS = {
    "ppo": lambda: make_on_policy_runner(actor=actor_cfg()),
    "augmented": lambda: make_on_policy_runner(actor=image_actor(AugmentedCnnModelCfg, shift=2)),
    "recurrent": lambda: make_on_policy_runner(actor=image_actor(RecurrentCnnModelCfg, rnn_hidden_dim=8)),
    "a2c": lambda: make_on_policy_runner(algorithm=RslRlA2cAlgorithmCfg()),
    "lagrangian": lambda: make_lagrangian_runner(SteerToDot(8)),
    "sac": make_sac_runner,
}


@pytest.mark.parametrize("name", RUNNERS)
@one_thread()
def test_same_seed_gives_the_same_weights(name):
    weights = []
    for _ in range(2):
        runner = RUNNERS[name]()
        start = [value.clone() for value in runner.alg.actor.parameters()]
        runner.learn(6)
        weights.append(list(runner.alg.actor.parameters()))
    assert all(torch.equal(first, second) for first, second in zip(*weights, strict=True))
    assert not all(torch.equal(before, after) for before, after in zip(start, weights[1], strict=True))
