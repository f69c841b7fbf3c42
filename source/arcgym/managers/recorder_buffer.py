# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Memory of the episodes that are under way."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

Values = dict[str, np.ndarray]
"""Arrays by name."""


class EpisodeBuffer:
    """Keeps the steps of all worlds on the host until the episodes they belong to are taken out.

    A step is one row for all worlds; worlds share no episode borders. Rows that no episode needs any more are dropped.
    """

    def __init__(self, num_worlds: int) -> None:
        """Start an episode in each of K worlds."""
        self._rows: deque[Values] = deque()
        self._first = 0
        self._start = [0] * num_worlds
        self._once: list[Values] = [{} for _ in range(num_worlds)]
        self._open: Values = {}

    def add(self, values: Values) -> None:
        """Add values of shape (K, ...) to the step under way."""
        self._open.update(values)

    def end_step(self) -> None:
        """End the step under way.

        Raises:
            ValueError: If it does not hold the same names as the steps before it.
        """
        if self._rows and self._open.keys() != self._rows[-1].keys():
            odd = sorted(self._open.keys() ^ self._rows[-1].keys())
            raise ValueError(f"Recorder terms must answer alike in every step; {odd} come in some steps only.")
        self._rows.append(self._open)
        self._open = {}

    def drop_step(self) -> None:
        """Forget the step under way."""
        self._open = {}

    def add_once(self, worlds: Sequence[int], values: Values) -> None:
        """Add values of shape (k, ...), one entry for each of ``worlds``, to their episodes."""
        for name, value in values.items():
            for world, entry in zip(worlds, value, strict=True):
                self._once[world][name] = entry

    def length(self, world: int) -> int:
        """Return the steps in the episode of a world."""
        return self._first + len(self._rows) - self._start[world]

    def take(self, world: int) -> Values:
        """Return the episode of a world, values of steps with shape (T, ...), and start its next one."""
        rows = [self._rows[k] for k in range(self._start[world] - self._first, len(self._rows))]
        episode = {name: np.stack([row[name][world] for row in rows]) for name in (rows[0] if rows else ())}
        episode |= self._once[world]
        self._once[world] = {}
        self._start[world] = self._first + len(self._rows)
        while self._first < min(self._start):
            self._rows.popleft()
            self._first += 1
        return episode
