# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Times of learners on noise: every agent that is measured runs, and its frames stack as a task's do."""

from __future__ import annotations

import pytest
import torch

from arcgym.benchmarks.learner.measure import GRADIENT_STEPS, Shapes, prepare, time_updates
from arcgym.benchmarks.learner.noise_env import NoiseEnv
from arcgym.cli.task import agent_key
from arcgym.utils.registry import load_cfg_from_registry
from arcgym.utils.threads import one_thread

TINY = Shapes(num_envs=2, size=36, num_states=3, num_actions=2)


@one_thread()
@pytest.mark.parametrize(
    ("agent", "variant", "steps"),
    [
        ("ppo", "plain", 18),
        ("ppo_recurrent", "amp", 6),
        ("ppo_lagrangian", "plain", 18),
        ("sac", "amp", GRADIENT_STEPS),
    ],
)
def test_agents_are_timed(agent, variant, steps):
    cfg = load_cfg_from_registry("ARC-Rectum-Magnetic", agent_key(agent))
    cfg.num_steps_per_env = 9
    if agent == "ppo_recurrent":
        cfg.algorithm.num_mini_batches = 2
    if agent == "sac":
        cfg.algorithm.replay_size, cfg.algorithm.batch_size = 100, 4
    row = time_updates(prepare(cfg, variant, TINY.num_envs), TINY, "cpu", repeats=1)
    assert row["gradient_steps"] == steps
    assert row["update_ms"] > 0.0 and row["act_ms"] > 0.0


def test_each_stack_holds_the_last_frames():
    env = NoiseEnv(1, 2, 3, 1, 1, [], "cpu")
    for _ in range(30):
        before = env.get_observations()["policy"]
        after = env.step(torch.zeros(1, 1))[0]["policy"]
        assert torch.equal(after[:, :6], before[:, 3:])
