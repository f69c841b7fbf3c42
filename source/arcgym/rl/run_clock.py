# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Time and transitions that a run has taken, over all its resumed parts."""

from __future__ import annotations

import time

import torch


class BudgetSpent(Exception):
    """The run has learnt for as long as it may."""


class RunClock:
    """Counts seconds of learning and transitions of a run, and knows when it has had its share."""

    def __init__(self, max_minutes: float | None = None, max_transitions: int | None = None):
        """Start a run that has taken nothing yet.

        Args:
            max_minutes: Minutes of learning that the run may take; None is without end.
            max_transitions: Transitions that the run may take; None is without end.
        """
        self.max_seconds = None if max_minutes is None else 60.0 * max_minutes
        self.max_transitions = max_transitions
        self.transitions = 0
        self._before = 0.0
        self._start: float | None = None

    @property
    def seconds(self) -> float:
        """Seconds of learning so far: collecting, updates, logs and checkpoints."""
        return self._before + (0.0 if self._start is None else time.perf_counter() - self._start)

    @property
    def fraction(self) -> float:
        """Share of the time or of the transitions that is over, the larger one; 0 without an end."""
        time_share = 0.0 if self.max_seconds is None else self.seconds / self.max_seconds
        return max(time_share, 0.0 if self.max_transitions is None else self.transitions / self.max_transitions)

    @property
    def limit(self) -> str:
        """Field of the agent's configuration that ends the run."""
        spent = self.max_transitions is not None and self.transitions >= self.max_transitions
        return "max_transitions" if spent else "max_minutes"

    def __str__(self) -> str:
        """Return what the run has taken, in words."""
        return f"{self.seconds / 60.0:.1f} minutes and {self.transitions} transitions"

    @property
    def is_over(self) -> bool:
        """Whether time or transitions are over. All processes of a run get the first one's answer."""
        if self.limit == "max_transitions":
            return True
        if self.max_seconds is None:
            return False
        is_over = torch.tensor(self.seconds >= self.max_seconds, dtype=torch.uint8)
        if torch.distributed.is_initialized():
            if torch.distributed.get_backend() == "nccl":
                is_over = is_over.cuda()
            torch.distributed.broadcast(is_over, src=0)
        return bool(is_over)

    def start(self) -> None:
        """Let the time run."""
        self._start = time.perf_counter()

    def stop(self) -> None:
        """Hold the time."""
        self._before, self._start = self.seconds, None

    def add(self, seconds: float, transitions: int) -> None:
        """Count what was done beside learning, such as asking an expert."""
        self._before += seconds
        self.transitions += transitions

    def state(self) -> dict[str, float]:
        """Return what a checkpoint keeps."""
        return {"seconds": self.seconds, "transitions": self.transitions}

    def restore(self, state: dict[str, float]) -> None:
        """Go on from a checkpoint."""
        self._before = float(state.get("seconds", 0.0))
        self.transitions = int(state.get("transitions", 0))
