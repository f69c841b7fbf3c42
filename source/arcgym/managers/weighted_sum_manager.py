# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Base of rewards and costs: a weighted sum of terms and its total over the episode."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, Any, ClassVar

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class WeightedSumManager(ManagerBase):
    """Adds ``weight * value * dt`` over its terms.

    A value that is not finite counts as zero: a world whose state is not finite is being reset. Those of other worlds
    are counted, see :meth:`ManagerBase.non_finite_terms`.
    """

    log_name: ClassVar[str]
    """First part of the names that :meth:`reset` logs."""

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolve the terms and evaluate each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values()
        self._zero = torch.zeros(self.num_envs, device=self.device)
        self._values = torch.zeros(len(self._terms), self.num_envs, device=self.device)
        self._sums = torch.zeros_like(self._values)
        self._dt = 1.0
        self._scales: list[float] = []
        self._scales_on_device = torch.zeros(0, 1, device=self.device)

    @property
    def step_values(self) -> dict[str, torch.Tensor]:
        """Weight times value of each term in the last step, shape (N,): a rate, which ``dt`` is not part of."""
        return dict(zip(self._terms, self._values / self._dt, strict=True))

    @property
    def step_parts(self) -> dict[str, torch.Tensor]:
        """Part of each term in the sum of the last step, shape (N,)."""
        return dict(zip(self._terms, self._values, strict=True))

    @property
    def episode_sums(self) -> dict[str, torch.Tensor]:
        """Sum of each term since the last reset of each world, shape (N,)."""
        return dict(zip(self._terms, self._sums, strict=True))

    def compute(self, dt: float) -> torch.Tensor:
        """Return the sum over all terms.

        Args:
            dt: Factor of every value: the control step [s], or 1 to leave values as they are.

        Returns:
            Sum of each world, shape (N,).
        """
        if not self._terms:
            return torch.zeros(self.num_envs, device=self.device)
        self._dt = dt
        values = [self._evaluate(name) if term.weight else self._zero for name, term in self._terms.items()]
        self._values = self._finite_rows(values) * self._scale(dt)
        self._sums += self._values
        return reduce(torch.add, self._values.unbind())  # in the order of the terms, whatever the number of worlds

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Return what to log, each term's mean episode sum over some worlds, and start them again from zero."""
        super().reset(env_ids)
        sums = self._sums if env_ids is None else self._sums[:, env_ids]
        means = sums.mean(dim=1) / self._log_divisor()
        fill_worlds(self._sums, env_ids, 0.0, dim=1)
        return {f"{self.log_name}/{name}": mean for name, mean in zip(self._terms, means, strict=True)}

    def _log_divisor(self) -> float:
        """Return the divisor of logged sums."""
        return 1.0

    def _scale(self, dt: float) -> torch.Tensor:
        """Weight of each term times ``dt``, shape (T, 1), sent to the device when it changes."""
        scales = [term.weight * dt for term in self._terms.values()]
        if scales != self._scales:
            self._scales = scales
            self._scales_on_device = torch.tensor(scales, dtype=torch.float32, device=self.device).unsqueeze(1)
        return self._scales_on_device

    def _columns(self) -> list[str]:
        return ["index", "name", "weight"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.weight] for index, (name, term) in enumerate(self._terms.items())]
