# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs trials in the worlds of one environment, each world taking the next trial when its episode ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import torch

from arcgym.evaluation.trial_queue import TrialQueue
from arcgym.evaluation.trials import Trial
from arcgym.rl.first_episodes import NON_FINITE
from arcgym.rl.rollout import Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

TrialRow = dict[str, Any]
"""One trial's results by column."""


def run_trials(
    env: RslRlVecEnvWrapper,
    make_policy: Callable[[RslRlVecEnvWrapper], Policy],
    trials: Sequence[Trial],
    on_row: Callable[[TrialRow], None],
) -> None:
    """Run every trial once.

    The result of a trial is the same whatever the number of worlds and the order of the trials: its random numbers
    follow from its seed, and no world sees another.

    Args:
        env: Environment; its worlds start anew.
        make_policy: Makes the policy, once the first trials have begun.
        trials: The trials, all of the patient in ``env``.
        on_row: Called with the row of each trial that ends: the fields of the trial, ``success`` (0 or 1), ``end`` (the
            termination term), ``reward`` (its sum), ``seconds``, ``cost_<name>`` (the sum of each cost), and the
            environment's metrics by name.
    """
    queue = TrialQueue(trials, env.num_envs)
    env.unwrapped.random.seed_source = queue
    try:
        env.reset()
        _run(env, make_policy(env), queue, on_row)
    finally:
        env.unwrapped.random.seed_source = None


def _run(env: RslRlVecEnvWrapper, policy: Policy, queue: TrialQueue, on_row: Callable[[TrialRow], None]) -> None:
    obs, sums = env.get_observations(), _EpisodeSums(env)
    with torch.inference_mode():
        while queue.left:
            running = queue.running
            obs, rewards, dones, extras = env.step(policy(obs))
            if hasattr(policy, "reset"):
                policy.reset(dones)
            sums.add(rewards, extras.get("costs", {}))
            ended = dones.nonzero().flatten().tolist()
            for world, row in zip(ended, sums.take(ended), strict=True):
                trial = running[world]
                if trial is not None:
                    on_row({**vars(trial), **row})


class _EpisodeSums:
    """Sums over the episode of every world, and what the environment says when it ends."""

    def __init__(self, env: RslRlVecEnvWrapper) -> None:
        self._env = env.unwrapped
        self._sums: dict[str, torch.Tensor] = {}

    def add(self, rewards: torch.Tensor, costs: dict[str, torch.Tensor]) -> None:
        """Take in a step: rewards and each cost's part, shape (N,)."""
        step = torch.full_like(rewards, self._env.step_dt, dtype=torch.float64)
        values = {"reward": rewards, "seconds": step, **{f"cost_{name}": value for name, value in costs.items()}}
        for name, value in values.items():
            self._sums[name] = self._sums.get(name, torch.zeros_like(step)) + value

    def take(self, worlds: list[int]) -> list[TrialRow]:
        """Return the rows of worlds whose episode has just ended, and start their sums again."""
        if not worlds:
            return []
        env = self._env
        ends = {name: env.termination_manager.get_term(name)[worlds].tolist() for name in _by_importance(env)}
        success = env.termination_manager.success[worlds].int().tolist()
        columns = {name: value[worlds].tolist() for name, value in self._sums.items()}
        metrics = {name: value[worlds].tolist() for name, value in env.metrics_manager.finished.items()}
        for value in self._sums.values():
            value[worlds] = 0.0
        return [
            {
                "success": success[k],
                "end": next((name for name in ends if ends[name][k]), NON_FINITE),
                **{name: value[k] for name, value in columns.items()},
                **{name: value[k] for name, value in metrics.items() if name != "success"},
            }
            for k in range(len(worlds))
        ]


def _by_importance(env: Any) -> list[str]:
    """Return the names of the termination terms: success first, then failures, then time limits."""
    terms = {name: env.termination_manager.get_term_cfg(name) for name in env.termination_manager.active_terms}
    return sorted(terms, key=lambda name: (not terms[name].success, terms[name].time_out))
