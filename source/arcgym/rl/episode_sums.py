# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What an episode comes to, as a row of figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch

from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

EpisodeRow = dict[str, Any]
"""One episode's results by column."""

NON_FINITE = "non_finite"
"""Reason of an episode that ended because the world's state was not finite."""


class EpisodeSums:
    """Sums over the episode of every world, and what the environment says when it ends."""

    def __init__(self, env: RslRlVecEnvWrapper) -> None:
        """Start counting in ``env``, whose worlds all begin an episode."""
        self._env = env.unwrapped
        self._sums: dict[str, torch.Tensor] = {}

    def add(self, rewards: torch.Tensor, costs: Mapping[str, torch.Tensor]) -> None:
        """Take in a step: rewards and each cost's part, shape (N,)."""
        step = torch.full_like(rewards, self._env.step_dt, dtype=torch.float64)
        values = {"reward": rewards, "seconds": step, **{f"cost_{name}": value for name, value in costs.items()}}
        for name, value in values.items():
            self._sums[name] = self._sums.get(name, torch.zeros_like(step)) + value

    def take(self, worlds: list[int]) -> list[EpisodeRow]:
        """Return the rows of worlds whose episode has just ended, and start their sums again.

        A row has ``success``, 0 or 1; ``end``, the termination term; ``reward``, its sum; ``seconds`` of the episode;
        ``cost_<name>``, the sum of each cost; then the environment's metrics by name.
        """
        if not worlds:
            return []
        env = self._env
        ends = {name: env.termination_manager.get_term(name)[worlds].tolist() for name in _by_importance(env)}
        success, failed = env.succeeded[worlds].int().tolist(), env.failed[worlds].tolist()
        columns = {name: value[worlds].tolist() for name, value in self._sums.items()}
        metrics = {name: value[worlds].tolist() for name, value in env.metrics_manager.finished.items()}
        for value in self._sums.values():
            value[worlds] = 0.0
        return [
            {
                "success": success[k],
                "end": NON_FINITE if failed[k] else next((name for name in ends if ends[name][k]), NON_FINITE),
                **{name: value[k] for name, value in columns.items()},
                **{name: value[k] for name, value in metrics.items() if name != "success"},
            }
            for k in range(len(worlds))
        ]


def _by_importance(env: Any) -> list[str]:
    """Return the names of the termination terms: success first, then failures, then time limits."""
    terms = {name: env.termination_manager.get_term_cfg(name) for name in env.termination_manager.active_terms}
    return sorted(terms, key=lambda name: (not terms[name].success, terms[name].time_out))
