# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Cost of whole episodes, undiscounted, of N worlds that end theirs at different times."""

from __future__ import annotations

import torch


class EpisodeCosts:
    """Adds up K costs over the episode of each world and averages them over the episodes that end.

    The first episode of each world is left out: it may have begun part of the way through its time limit.
    """

    def __init__(self, num_costs: int, num_envs: int, device: str):
        """Start with nothing known about any episode."""
        self._sums = torch.zeros(num_costs, num_envs, device=device)
        self._is_whole = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self._totals = torch.zeros(num_costs + 1, device=device)

    def add(self, costs: torch.Tensor, dones: torch.Tensor) -> None:
        """Add the costs of one step, shape (K, N), and end the episodes where ``dones``, shape (N,), is not zero."""
        done = dones > 0
        counted = done & self._is_whole
        self._sums += costs
        self._totals[:-1] += (self._sums * counted).sum(dim=1)
        self._totals[-1] += counted.sum()
        self._sums.masked_fill_(done, 0.0)
        self._is_whole |= done

    def take_means(self, min_episodes: int = 1) -> list[float] | None:
        """Return the mean cost of the episodes that ended since the last answer, and start again.

        With several processes the mean is over the episodes of all of them.

        Args:
            min_episodes: With fewer than this the answer is None and they are kept for the next time.
        """
        totals = self._totals.clone()
        if torch.distributed.is_initialized():
            torch.distributed.all_reduce(totals)
        *sums, episodes = totals.tolist()
        if episodes < max(min_episodes, 1):
            return None
        self._totals.zero_()
        return [total / episodes for total in sums]
