# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a scope is pulled back to straighten its loops, and for how long. N worlds."""

from __future__ import annotations

import torch

STRAIGHT = 0.25
"""Share of the slack below which loops count as straightened."""
LONGEST = 120
"""Control steps after which it ends anyway."""
FRESH = 0.05
"""Way that the tip gets on beyond where it was last pulled back, before that is done again [m]."""
AGAIN = 150
"""Control steps after which it is done again though the tip does not get on."""
NEAR_ANUS = 0.15
"""Arc length below which there are no loops: the rectum [m]."""


class Loops:
    """Compares the length of scope inside with the way of its tip: what is more than it once was lies in loops."""

    def __init__(self, num_envs: int, device: str, slack: torch.Tensor, slips: torch.Tensor):
        """Start anew.

        Args:
            num_envs: Number of worlds N.
            device: Device of the tensors.
            slack: Length of scope in loops from which they are straightened [m], shape (N,).
            slips: Way that the tip may slip back meanwhile [m], shape (N,).
        """
        self.slack, self.slips = slack, slips
        self._least = torch.full((num_envs,), float("inf"), device=device)
        self._from = torch.full_like(self._least, -1.0)
        self._left = torch.zeros(num_envs, dtype=torch.long, device=device)
        self._since = torch.zeros_like(self._left)

    @property
    def memory(self) -> list[torch.Tensor]:
        """What it remembers of every world, N entries each."""
        return [self._least, self._from, self._left, self._since]

    def update(self, arc: torch.Tensor, inserted: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Take note of the arc lengths of the tips and the lengths inside [m], shape (N,).

        Returns:
            Which worlds straighten their loops, and which begin to, both of shape (N,), bool.
        """
        over = inserted - arc
        self._least = torch.where(arc > NEAR_ANUS, torch.minimum(self._least, over), self._least)
        looped = over - self._least
        due = (arc > self._from + FRESH) | (self._since > AGAIN)
        begins = (looped > self.slack) & (self._left == 0) & due & (arc > NEAR_ANUS)
        self._from = torch.where(begins, arc, self._from)
        goes_on = (self._left > 0) & (looped > STRAIGHT * self.slack) & (arc > self._from - self.slips)
        self._left = torch.where(begins, LONGEST, torch.where(goes_on, self._left - 1, 0))
        self._since = torch.where(self._left > 0, 0, self._since + 1)
        return self._left > 0, begins

    def reset(self, env_ids: torch.Tensor) -> None:
        """Forget the past of some worlds."""
        self._least[env_ids] = float("inf")
        self._from[env_ids] = -1.0
        self._left[env_ids] = 0
        self._since[env_ids] = 0
