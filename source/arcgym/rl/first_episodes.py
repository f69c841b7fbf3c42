# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What each world's first episode comes to, in a row an episode."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from arcgym.rl.run_folder import write_whole
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper

NON_FINITE = "non_finite"
"""Reason of an episode that ended because the world's state was not finite."""


class FirstEpisodes:
    """Sums over a rollout of N worlds; of episodes it takes in each world's first one and no other."""

    def __init__(self, env: RslRlVecEnvWrapper) -> None:
        """Start counting in ``env``, whose worlds all begin an episode."""
        self.env = env
        self.steps = 0
        """Control steps so far."""
        self._total = torch.zeros((), device=env.device)
        self._returns = torch.zeros(env.num_envs, device=env.device)
        self._lengths = torch.zeros(env.num_envs, dtype=torch.long, device=env.device)
        self._has_ended = torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
        self._has_succeeded = torch.zeros_like(self._has_ended)
        self._ends = torch.full_like(self._lengths, -1)
        self._costs: dict[str, torch.Tensor] = {}
        self._metrics: dict[str, torch.Tensor] = {}

    @property
    def metrics(self) -> dict[str, float]:
        """Mean of each of the environment's metrics over the episodes that ended; empty when none has."""
        if not bool(self._has_ended.any()):
            return {}
        return {name: float(values[self._has_ended].mean()) for name, values in self._metrics.items()}

    @property
    def reward_per_step(self) -> float:
        """Mean reward of a control step of a world, over all steps."""
        return float(self._total) / max(self.steps * self.env.num_envs, 1)

    def add(self, rewards: torch.Tensor, done: torch.Tensor, costs: Mapping[str, torch.Tensor]) -> None:
        """Take in a step.

        Args:
            rewards: Shape (N,).
            done: Worlds whose episode ended, bool, shape (N,).
            costs: Each cost's part of the step, shape (N,), by name.
        """
        env = self.env.unwrapped
        self.steps += 1
        self._total += rewards.sum()
        running = ~self._has_ended
        self._returns += rewards * running
        self._lengths += running
        for name, cost in costs.items():
            self._costs[name] = self._costs.get(name, torch.zeros_like(cost)) + cost * running
        ends = done & running
        self._has_succeeded |= ends & env.termination_manager.success
        for index, name in enumerate(env.termination_manager.active_terms):
            self._ends = torch.where(ends & env.termination_manager.get_term(name), index, self._ends)
        for name, values in env.metrics_manager.finished.items():
            self._metrics[name] = torch.where(ends, values, self._metrics.get(name, torch.zeros_like(values)))
        self._has_ended |= done

    def is_complete(self) -> bool:
        """Return whether each world's first episode has ended. Waits for the device."""
        return bool(self._has_ended.all())

    def rows(self) -> list[dict[str, Any]]:
        """Return a dict for each first episode that ended.

        ``world``; ``success``, 0 or 1; ``end``, the termination term; ``reward``, its sum; ``seconds`` of the episode;
        ``cost_<name>``, the sum of each cost; then the environment's metrics by name.
        """
        names = list(self.env.unwrapped.termination_manager.active_terms)
        columns: dict[str, list[Any]] = {
            "world": list(range(self.env.num_envs)),
            "success": self._has_succeeded.int().tolist(),
            "end": [names[index] if index >= 0 else NON_FINITE for index in self._ends.tolist()],
            "reward": self._returns.tolist(),
            "seconds": (self._lengths * self.env.unwrapped.step_dt).tolist(),
            **{f"cost_{name}": values.tolist() for name, values in self._costs.items()},
            **{name: values.tolist() for name, values in self._metrics.items() if name != "success"},
        }
        rows = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
        return [row for row, ended in zip(rows, self._has_ended.tolist(), strict=True) if ended]


def write_rows(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write dicts with the same names as a CSV file, whole or not at all; no rows make an empty file."""
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    write_whole(path, text.getvalue().encode())


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a CSV file, numbers as floats."""
    with path.open(newline="") as file:
        return [{name: _number(value) for name, value in row.items()} for row in csv.DictReader(file)]


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text
