# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a tip that does not get on backs off, and for how long. N worlds."""

from __future__ import annotations

import torch

GAIN = 0.004
"""Way that counts as progress [m]."""
NEAR_ANUS = 0.03
"""Arc length below which no tip backs off [m]."""


class Retreat:
    """Counts the control steps without progress; each further attempt backs off longer.

    Without :data:`GAIN` at last it goes back for ``longest`` of every ``longest + patience`` steps: a pulled tip for 4
    of every 6 s from the seventh attempt on, a pushed one, unless told otherwise, for 6 of every 12 from the sixth. One
    that creeps on is taken for stuck, too.
    """

    def __init__(self, num_envs: int, device: str, patience: float | torch.Tensor, first: int, longest: int):
        """Start anew.

        Args:
            num_envs: Number of worlds N.
            device: Device of the tensors.
            patience: Control steps without progress after which a tip backs off, one number or one a world.
            first: Control steps for which it first does.
            longest: Control steps for which it does at most.
        """
        self.patience, self.first, self.longest = patience, first, longest
        self._best = torch.full((num_envs,), -1.0, device=device)
        self._waited = torch.zeros(num_envs, dtype=torch.long, device=device)
        self._tries, self._left = torch.zeros_like(self._waited), torch.zeros_like(self._waited)

    @property
    def memory(self) -> list[torch.Tensor]:
        """What it remembers of every world, N entries each."""
        return [self._best, self._waited, self._tries, self._left]

    def update(self, arc: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Take note of the arc lengths of the tips [m], shape (N,).

        Returns:
            Which worlds back off, and which begin to, both of shape (N,), bool.
        """
        gained = arc > self._best + GAIN
        self._best = torch.where(gained, arc, self._best)
        self._waited = torch.where(gained, 0, self._waited + (self._left == 0))
        self._tries = torch.where(gained, 0, self._tries)
        tired = (self._waited > self.patience) & (arc > NEAR_ANUS)
        self._waited = torch.where(tired, 0, self._waited)
        self._tries = self._tries + tired
        length = (self.first * self._tries).clamp(max=self.longest)
        self._left = torch.where(tired, length, (self._left - 1).clamp(min=0))
        self._left = torch.where(arc < NEAR_ANUS, 0, self._left)
        return self._left > 0, tired

    def reset(self, env_ids: torch.Tensor) -> None:
        """Forget the past of some worlds."""
        self._best[env_ids] = -1.0
        for count in (self._waited, self._tries, self._left):
            count[env_ids] = 0
