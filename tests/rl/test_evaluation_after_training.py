# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest
import torch
from test_rollout import wrap

from arcgym.rl.constrained_runner import ConstrainedPolicy
from arcgym.rl.evaluation import evaluate
from arcgym.rl.first_episodes import read_rows


class Forward(torch.nn.Module):
    """Asks for 1 on the first axis, which is the reward of a step."""

    def forward(self, obs) -> torch.Tensor:
        return torch.tensor([[1.0, 0.0]]).repeat(2, 1)

    def reset(self, dones=None) -> None:
        pass


class Half:
    """A rule that halves every action."""

    def __call__(self, actions: torch.Tensor) -> torch.Tensor:
        return 0.5 * actions

    def reset(self, dones=None) -> None:
        pass


@pytest.fixture
def env(counting_env):
    """Episodes of four steps, so that a policy earns four times its first action."""
    return wrap(counting_env, success=[True, False])


def rewards(folder, prefix: str) -> tuple[float, list[float]]:
    mean = json.loads((folder / f"{prefix}evaluation.json").read_text())["reward_per_episode"]
    return mean, [row["reward"] for row in read_rows(folder / f"{prefix}episodes.csv")]


def test_a_policy_with_rules_is_run_without_them_too(env, tmp_path):
    policy = ConstrainedPolicy(Forward(), Half())
    evaluate(SimpleNamespace(get_inference_policy=lambda device: policy), env, "cpu", tmp_path)
    assert rewards(tmp_path, "") == (2.0, [2.0, 2.0])
    assert rewards(tmp_path, "without_rules_") == (4.0, [4.0, 4.0])


def test_a_policy_without_rules_is_run_once(env, tmp_path):
    evaluate(SimpleNamespace(get_inference_policy=lambda device: Forward()), env, "cpu", tmp_path)
    assert rewards(tmp_path, "") == (4.0, [4.0, 4.0])
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["episodes.csv", "evaluation.json"]
