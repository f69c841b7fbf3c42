# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Going back with a scope that no longer comes on, in place of what is commanded. N worlds."""

from __future__ import annotations

import math

import torch

from arcgym.utils.worlds import fill_worlds

ADVANCE = 0.005
"""Length that has to go inside for a scope to come on [m]: more than it moves to and fro where it is held."""


class BackOff:
    """Says where to go back for a while: where for some time hardly more scope has gone inside, as examiners do.

    It reads the length inside, which whoever holds the scope sees at the anus, and no image. The wait begins with the
    first control step of an episode and behind each time of going back.
    """

    def __init__(self, after: float, duration: float, step_dt: float, num_envs: int, device: str):
        """Start all worlds with nothing waited.

        Args:
            after: Time without 5 mm more inside after which a scope goes back [s], one control step at least.
            duration: Time for which it goes back [s], one control step at least.
            step_dt: Control step [s].
            num_envs: Number of worlds N.
            device: Device of the tensors.
        """
        self._after, self._duration = (max(1, round(time / step_dt)) for time in (after, duration))
        self._reached = torch.full((num_envs,), -math.inf, device=device)
        self._waited = torch.zeros(num_envs, device=device)
        self._left = torch.zeros(num_envs, device=device)

    @property
    def active(self) -> torch.Tensor:
        """Worlds whose scope goes back in the present control step, bool, shape (N,)."""
        return self._left > 0.0

    def advance(self, inserted: torch.Tensor) -> None:
        """Begin a control step with the given lengths of scope inside [m], shape (N,)."""
        anew = (inserted > self._reached + ADVANCE) | self.active
        self._reached = torch.where(anew, inserted, self._reached)
        self._waited = torch.where(anew, 0.0, self._waited + 1.0)
        starts = self._waited >= self._after
        self._left = torch.where(starts, float(self._duration), (self._left - 1.0).clamp(min=0.0))

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Set the given worlds back to nothing waited, whatever length is inside when they begin."""
        fill_worlds(self._reached, env_ids, -math.inf)
        fill_worlds(self._waited, env_ids, 0.0)
        fill_worlds(self._left, env_ids, 0.0)
