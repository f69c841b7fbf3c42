# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What each world's first episode comes to, in a row an episode."""

from __future__ import annotations

import csv
import io
import statistics
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from arcgym.rl.episode_sums import EpisodeRow, EpisodeSums
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.files import write_whole


class FirstEpisodes:
    """Sums over a rollout of N worlds; of episodes it takes in each world's first one and no other."""

    def __init__(self, env: RslRlVecEnvWrapper) -> None:
        """Start counting in ``env``, whose worlds all begin an episode."""
        self.env = env
        self.steps = 0
        """Control steps so far."""
        self._total = torch.zeros((), device=env.device)
        self._sums = EpisodeSums(env)
        self._rows: dict[int, EpisodeRow] = {}

    @property
    def metrics(self) -> dict[str, float]:
        """Mean of each of the environment's metrics over the episodes that ended; empty when none has."""
        names = self.env.unwrapped.metrics_manager.active_terms if self._rows else ()
        return {name: statistics.fmean(row[name] for row in self._rows.values()) for name in names}

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
        self.steps += 1
        self._total += rewards.sum()
        self._sums.add(rewards, costs)
        ended = done.nonzero().flatten().tolist()
        for world, row in zip(ended, self._sums.take(ended), strict=True):
            self._rows.setdefault(world, row)

    def is_complete(self) -> bool:
        """Return whether each world's first episode has ended."""
        return len(self._rows) == self.env.num_envs

    def rows(self) -> list[EpisodeRow]:
        """Return a row for each first episode that ended: ``world``, then the columns of :class:`EpisodeSums`."""
        return [{"world": world, **row} for world, row in sorted(self._rows.items())]


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
