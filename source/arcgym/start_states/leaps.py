# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds whose tip leapt along the lumen: it went through the wall from one loop into another. N worlds."""

from __future__ import annotations

import torch

LEAP = 0.08
"""Way along the lumen that no tip gets on in a control step of 0.1 s, however sharp the bend [m]."""


class Leaps:
    """Compares the arc length of each tip with where it last was in place. Who leapt is lost until it takes over."""

    def __init__(self, arc: torch.Tensor):
        """Start where the tips are.

        Args:
            arc: Arc lengths of the tips [m], shape (N,).
        """
        self.lost = torch.zeros_like(arc, dtype=torch.bool)
        """Which worlds have leapt, shape (N,), bool."""
        self._last = arc.clone()

    @property
    def memory(self) -> list[torch.Tensor]:
        """What it remembers of every world, N entries each."""
        return [self.lost, self._last]

    def update(self, arc: torch.Tensor, in_place: torch.Tensor) -> torch.Tensor:
        """Take note of a control step.

        Args:
            arc: Arc lengths of the tips [m], shape (N,).
            in_place: Which tips are inside of the lumen, shape (N,), bool.

        Returns:
            Which worlds have leapt by now, shape (N,), bool.
        """
        self.lost |= in_place & ((arc - self._last).abs() > LEAP)
        self._last = torch.where(in_place & ~self.lost, arc, self._last)
        return self.lost

    def take_over(self, moved: torch.Tensor, sources: torch.Tensor) -> None:
        """Let worlds go on as others, both int64, shape (n,)."""
        self.lost[moved], self._last[moved] = self.lost[sources], self._last[sources]
