# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a gently pushed scope is pulled back with a hooked tip, and for how long. N worlds."""

from __future__ import annotations

import torch

PRESSED = 5
"""Control steps in a row above the largest push after which the scope is pulled back."""
REST = 20
"""Control steps for which it then goes on at least."""
LONGEST = 400
"""Control steps after which a pull may be asked for again though less scope is inside than at the last one's start."""
NEAR_ANUS = 0.15
"""Arc length of the tip below which there is nothing to straighten [m]: the rectum."""


class PullBack:
    """A pull begins after a push that is too hard; it ends when the tip slips, or it is too hard or long enough."""

    def __init__(self, most_push: torch.Tensor, slips: torch.Tensor, pull: torch.Tensor):
        """Start anew.

        Args:
            most_push: Push or pull on the base that ends a push or a pull [N], shape (N,).
            slips: Way that the tip may slip back meanwhile [m], shape (N,).
            pull: Length of shaft that is pulled out at most [m], shape (N,).
        """
        self.most_push, self.slips, self.pull = most_push, slips, pull
        self._pressed, self._rested, self._arc, self._inserted = (torch.zeros_like(pull) for _ in range(4))
        self._pulling = torch.zeros_like(pull, dtype=torch.bool)

    @property
    def memory(self) -> list[torch.Tensor]:
        """What it remembers of every world, N entries each."""
        return [self._pressed, self._rested, self._arc, self._inserted, self._pulling]

    def update(
        self, arc: torch.Tensor, inserted: torch.Tensor, push: torch.Tensor, asked: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Take note of arc lengths of the tips and lengths inside [m], pushes on the base [N], each of shape (N,).

        Args:
            arc: Arc length of each tip.
            inserted: Length of scope inside.
            push: Push on the base.
            asked: Where a pull is to begin for another reason, bool; heard once what was pulled out is in again.

        Returns:
            Which worlds are pulled back, and which begin to be, both of shape (N,), bool.
        """
        self._pressed.copy_(torch.where(push > self.most_push, self._pressed + 1.0, 0.0))
        self._rested.copy_(torch.where(self._pulling, 0.0, self._rested + 1.0))
        hard = (self._pressed >= PRESSED) & (self._rested > REST)
        heard = asked & ((inserted >= self._inserted) | (self._rested > LONGEST))
        begins = (hard | heard) & ~self._pulling & (arc > NEAR_ANUS)
        self._arc.copy_(torch.where(begins, arc, self._arc))
        self._inserted.copy_(torch.where(begins, inserted, self._inserted))
        holds = (arc > self._arc - self.slips) & (inserted > self._inserted - self.pull) & (push > -self.most_push)
        self._pulling.copy_(begins | (self._pulling & holds))
        return self._pulling.clone(), begins

    def reset(self, env_ids: torch.Tensor) -> None:
        """Forget the past of some worlds."""
        for array in self.memory:
            array[env_ids] = 0
