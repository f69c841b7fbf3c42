# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runs a policy in an environment and counts what comes of it."""

from __future__ import annotations

import json
import math
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import torch
from tensordict import TensorDict

from arcgym.rl.expert_policy import ExpertPolicy
from arcgym.rl.first_episodes import FirstEpisodes
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

Policy = Callable[[TensorDict], torch.Tensor]
"""Maps observations of N worlds to raw actions of shape (N, A)."""


@dataclass(frozen=True)
class RolloutResult:
    """What a policy achieved in all worlds.

    Figures of episodes count each world's first one and no other: short episodes fit more often into a number of steps
    than long ones, and would count more.
    """

    steps: int
    """Control steps made by each world."""

    num_envs: int
    """Number of worlds."""

    reward_per_step: float
    """Mean reward of a control step of a world, over all steps."""

    episodes: int
    """Worlds whose first episode ended."""

    reward_per_episode: float
    """Mean sum of rewards of these episodes; NaN when none ended."""

    success_rate: float
    """Fraction of these episodes that a termination term with ``success=True`` ended; NaN when none ended."""

    wall_time: float
    """Real time that it took [s]."""

    metrics: dict[str, float] = field(default_factory=dict)
    """Mean of each ``Episode_Metrics/…`` over these episodes."""

    first_episodes: list[dict[str, Any]] = field(default_factory=list, repr=False)
    """What each of these episodes was, see :meth:`arcgym.rl.first_episodes.FirstEpisodes.rows`."""

    def to_json(self) -> str:
        """Return all figures but the list of episodes as one line of JSON; what no episode gave is null."""
        figures = {name: None if value != value else value for name, value in asdict(self).items()}
        del figures["first_episodes"]
        return json.dumps(figures)

    def __str__(self) -> str:
        """Return the figures in one line."""
        text = f"{self.steps} steps in {self.wall_time:.1f} s, mean reward {self.reward_per_step:.4f} a step, "
        if not self.episodes:
            return text + "no episode ended"
        return text + (
            f"first episode of {self.episodes} of {self.num_envs} worlds ended, "
            f"{self.reward_per_episode:.3f} each, success {self.success_rate:.0%}"
        )


def zero_policy(env: RslRlVecEnvWrapper) -> Policy:
    """Return the policy whose raw actions are zero."""
    return lambda obs: torch.zeros(env.num_envs, env.num_actions, device=env.device)


def random_policy(env: RslRlVecEnvWrapper) -> Policy:
    """Return the policy whose raw actions are uniform in [-1, 1], drawn from the worlds' own random numbers."""
    return lambda obs: 2.0 * env.unwrapped.random.uniform("random policy", env.num_actions) - 1.0


UNTRAINED_POLICIES: dict[str, Callable[[RslRlVecEnvWrapper], Policy]] = {
    "zero": zero_policy,
    "random": random_policy,
    "expert": ExpertPolicy,
}
"""Policies that need no checkpoint, by name: those of :data:`arcgym.utils.untrained.UNTRAINED`."""


def run_policy(
    env: RslRlVecEnvWrapper,
    policy: Policy,
    steps: int | None = None,
    on_step: Callable[[int], None] | None = None,
) -> RolloutResult:
    """Run ``policy`` in every world.

    Args:
        env: Environment whose worlds all begin an episode.
        policy: Maps observations to raw actions; one with memory is given ``reset(dones)`` after each step.
        steps: Control steps; None ends when each world's first episode has ended, which the time limit bounds.
        on_step: Called after every step with the number of steps done.
    """
    start = time.perf_counter()
    tally = FirstEpisodes(env)
    obs = env.get_observations()
    with torch.inference_mode():
        while tally.steps < (steps or env.max_episode_length) and (steps or not tally.is_complete()):
            obs, rewards, dones, extras = env.step(policy(obs))
            if hasattr(policy, "reset"):
                policy.reset(dones)
            tally.add(rewards, dones > 0, extras.get("costs", {}))
            if on_step is not None:
                on_step(tally.steps)
    rows = tally.rows()
    return RolloutResult(
        steps=tally.steps,
        num_envs=env.num_envs,
        reward_per_step=tally.reward_per_step,
        episodes=len(rows),
        reward_per_episode=_mean(rows, "reward"),
        success_rate=_mean(rows, "success"),
        wall_time=time.perf_counter() - start,
        metrics={f"Episode_Metrics/{name}": value for name, value in tally.metrics.items()},
        first_episodes=rows,
    )


def _mean(rows: list[dict[str, Any]], name: str) -> float:
    """Return the mean of a column; NaN when there is no row."""
    return statistics.fmean(row[name] for row in rows) if rows else math.nan
