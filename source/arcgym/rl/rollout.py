# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runs a policy in an environment and counts what comes of it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import torch
from tensordict import TensorDict

from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

Policy = Callable[[TensorDict], torch.Tensor]
"""Maps observations of N worlds to raw actions of shape (N, A)."""


@dataclass(frozen=True)
class RolloutResult:
    """What a policy achieved over a number of control steps in all worlds."""

    steps: int
    """Control steps made by each world."""

    reward_per_step: float
    """Mean reward of a control step of a world."""

    episodes: int
    """Episodes that ended."""

    reward_per_episode: float
    """Mean sum of rewards of the episodes that ended; NaN when none did."""

    success_rate: float
    """Fraction of the ended episodes that a termination term with ``success=True`` ended; NaN when none ended."""

    wall_time: float
    """Duration [s]."""

    metrics: dict[str, float] = field(default_factory=dict)
    """Mean of each ``Episode_Metrics/…`` over the episodes that ended."""

    def to_json(self) -> str:
        """Return all figures as one line of JSON; what no episode gave is null."""
        figures = {name: None if value != value else value for name, value in asdict(self).items()}
        return json.dumps(figures)

    def __str__(self) -> str:
        """Return the figures in one line."""
        return (
            f"{self.steps} steps in {self.wall_time:.1f} s, mean reward {self.reward_per_step:.4f} a step, "
            f"{self.episodes} episodes ended, {self.reward_per_episode:.3f} each, success {self.success_rate:.0%}"
            if self.episodes
            else f"{self.steps} steps in {self.wall_time:.1f} s, mean reward {self.reward_per_step:.4f} a step, "
            "no episode ended"
        )


def zero_policy(env: RslRlVecEnvWrapper) -> Policy:
    """Return the policy whose raw actions are zero."""
    return lambda obs: torch.zeros(env.num_envs, env.num_actions, device=env.device)


def random_policy(env: RslRlVecEnvWrapper) -> Policy:
    """Return the policy whose raw actions are uniform in [-1, 1]."""
    return lambda obs: 2.0 * torch.rand(env.num_envs, env.num_actions, device=env.device) - 1.0


UNTRAINED: dict[str, Callable[[RslRlVecEnvWrapper], Policy]] = {"zero": zero_policy, "random": random_policy}
"""Policies that need no checkpoint, by name."""


def run_policy(env: RslRlVecEnvWrapper, policy: Policy, steps: int) -> RolloutResult:
    """Run ``policy`` for ``steps`` control steps in every world."""
    start = time.perf_counter()
    returns = torch.zeros(env.num_envs, device=env.device)
    total, ended, succeeded, ended_returns = (torch.zeros((), device=env.device) for _ in range(4))
    metrics: dict[str, float] = {}
    obs = env.get_observations()
    with torch.inference_mode():
        for _ in range(steps):
            obs, rewards, dones, extras = env.step(policy(obs))
            done = dones > 0
            _add_metrics(metrics, extras.get("log", {}), int(done.sum()))
            returns += rewards
            total += rewards.sum()
            ended += done.sum()
            succeeded += (env.unwrapped.termination_manager.success & done).sum()
            ended_returns += (returns * done).sum()
            returns[done] = 0.0
    episodes = int(ended)
    return RolloutResult(
        steps=steps,
        reward_per_step=float(total) / (steps * env.num_envs),
        episodes=episodes,
        reward_per_episode=float(ended_returns) / episodes if episodes else float("nan"),
        success_rate=float(succeeded) / episodes if episodes else float("nan"),
        wall_time=time.perf_counter() - start,
        metrics={name: value / episodes for name, value in metrics.items()} if episodes else {},
    )


def _add_metrics(sums: dict[str, float], log: dict[str, Any], episodes: int) -> None:
    """Add the means over ``episodes`` that a step's log holds, times their number."""
    for name, value in log.items():
        if name.startswith("Episode_Metrics/") and episodes:
            sums[name] = sums.get(name, 0.0) + float(value) * episodes
