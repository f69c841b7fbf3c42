# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Memory of the steps that are not yet on disk."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

Values = dict[str, np.ndarray]
"""Arrays by name."""


class EpisodeBuffer:
    """Keeps the steps of all worlds on the host until they are taken out, world by world.

    A step is one row for all worlds; worlds share no episode borders. Rows that no world needs any more are dropped.
    """

    def __init__(self, num_worlds: int) -> None:
        """Start with nothing in each of K worlds."""
        self._rows: deque[Values] = deque()
        self._first = 0
        self._start = [0] * num_worlds
        self._once: list[Values] = [{} for _ in range(num_worlds)]
        self._open: Values = {}
        self._names: set[str] | None = None

    @property
    def is_open(self) -> bool:
        """Whether a step is under way."""
        return bool(self._open)

    def add(self, values: Values) -> None:
        """Add values of shape (K, ...) to the step under way."""
        self._open.update(values)

    def end_step(self) -> None:
        """End the step under way.

        Raises:
            ValueError: If it does not hold the same names as the steps before it.
        """
        if self._names is not None and self._open.keys() != self._names:
            odd = sorted(self._open.keys() ^ self._names)
            raise ValueError(f"Recorder terms must answer alike in every step; {odd} come in some steps only.")
        self._names = set(self._open)
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
        """Return the steps of a world that wait to be taken."""
        return self._first + len(self._rows) - self._start[world]

    def take(self, world: int) -> Values:
        """Return and forget the steps of a world, shape (T, ...)."""
        start = self._start[world] - self._first
        rows = [self._rows[k] for k in range(start, len(self._rows))]
        steps = {name: np.stack([row[name][world] for row in rows]) for name in (rows[0] if rows else ())}
        self._start[world] += len(rows)
        self._forget()
        return steps

    def take_once(self, world: int) -> Values:
        """Return and forget what a world's episode holds once."""
        once, self._once[world] = self._once[world], {}
        return once

    def shorten(self, world: int, count: int) -> None:
        """Forget the last ``count`` steps of the only world.

        Raises:
            ValueError: If there are several worlds, which share rows, or fewer steps.
        """
        if len(self._start) != 1 or count > self.length(world):
            raise ValueError(
                f"{count} steps cannot be taken back: {len(self._start)} worlds, {self.length(world)} steps."
            )
        for _ in range(count):
            self._rows.pop()

    def _forget(self) -> None:
        while self._first < min(self._start):
            self._rows.popleft()
            self._first += 1
