# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runs a policy in an environment and counts what comes of it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field

import torch
from tensordict import TensorDict

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
    """Duration [s]."""

    metrics: dict[str, float] = field(default_factory=dict)
    """Mean of each ``Episode_Metrics/…`` over these episodes."""

    def to_json(self) -> str:
        """Return all figures as one line of JSON; what no episode gave is null."""
        figures = {name: None if value != value else value for name, value in asdict(self).items()}
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
    """Return the policy whose raw actions are uniform in [-1, 1]."""
    return lambda obs: 2.0 * torch.rand(env.num_envs, env.num_actions, device=env.device) - 1.0


UNTRAINED: dict[str, Callable[[RslRlVecEnvWrapper], Policy]] = {"zero": zero_policy, "random": random_policy}
"""Policies that need no checkpoint, by name."""


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
    tally = _Tally(env)
    obs = env.get_observations()
    with torch.inference_mode():
        while tally.steps < (steps or env.max_episode_length) and (steps or not tally.is_complete()):
            obs, rewards, dones, _ = env.step(policy(obs))
            if hasattr(policy, "reset"):
                policy.reset(dones)
            tally.add(rewards, dones > 0)
            if on_step is not None:
                on_step(tally.steps)
    return tally.result(time.perf_counter() - start)


class _Tally:
    """Sums over a rollout, of each world's first episode where they are of episodes."""

    def __init__(self, env: RslRlVecEnvWrapper) -> None:
        self.env = env
        self.steps = 0
        self.total = torch.zeros((), device=env.device)
        self.returns = torch.zeros(env.num_envs, device=env.device)
        self.has_ended = torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
        self.has_succeeded = torch.zeros_like(self.has_ended)
        self.metrics: dict[str, torch.Tensor] = {}

    def add(self, rewards: torch.Tensor, done: torch.Tensor) -> None:
        """Take in a step: rewards, shape (N,), and the worlds that are done, bool, shape (N,)."""
        self.steps += 1
        self.total += rewards.sum()
        self.returns += rewards * ~self.has_ended
        ends = done & ~self.has_ended
        self.has_succeeded |= ends & self.env.unwrapped.termination_manager.success
        for name, values in self.env.unwrapped.metrics_manager.finished.items():
            self.metrics[name] = torch.where(ends, values, self.metrics.get(name, torch.zeros_like(values)))
        self.has_ended |= done

    def is_complete(self) -> bool:
        """Return whether each world's first episode has ended. Waits for the device."""
        return bool(self.has_ended.all())

    def result(self, wall_time: float) -> RolloutResult:
        """Return the figures."""
        episodes = int(self.has_ended.sum())
        return RolloutResult(
            steps=self.steps,
            num_envs=self.env.num_envs,
            reward_per_step=float(self.total) / max(self.steps * self.env.num_envs, 1),
            episodes=episodes,
            reward_per_episode=self._mean(self.returns),
            success_rate=self._mean(self.has_succeeded.float()),
            wall_time=wall_time,
            metrics={f"Episode_Metrics/{name}": self._mean(value) for name, value in self.metrics.items()}
            if episodes
            else {},
        )

    def _mean(self, values: torch.Tensor) -> float:
        """Return the mean over the worlds whose first episode ended; NaN when there is none."""
        return float(values[self.has_ended].mean())
