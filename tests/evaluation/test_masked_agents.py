# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rules on actions are outside the batches: they look at the worlds as they are."""

from __future__ import annotations

import torch
from tensordict import TensorDict

from arcgym.evaluation import agents
from arcgym.rl.constrained_runner import ConstrainedPolicy


class Rules:
    """Halves the actions; a generator stands for the simulator, which cannot be copied."""

    def __init__(self) -> None:
        self.simulator = (number for number in range(3))
        self.worlds = 0

    def __call__(self, actions: torch.Tensor) -> torch.Tensor:
        self.worlds = len(actions)
        return 0.5 * actions


class Env:
    num_envs = 3


def test_rules_see_each_world_once(monkeypatch) -> None:
    rules = Rules()
    trained = ConstrainedPolicy(lambda obs: 2.0 * obs["policy"], rules)
    monkeypatch.setattr(agents, "trained_policy", lambda *_: trained)
    policy = agents.trained_agent(Env(), None, None)
    obs = TensorDict({"policy": torch.tensor([[1.0], [2.0], [3.0]])}, batch_size=[3])
    assert policy(obs).tolist() == [[1.0], [2.0], [3.0]]
    assert rules.worlds == 3
