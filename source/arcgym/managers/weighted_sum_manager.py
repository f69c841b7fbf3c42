# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What rewards and costs share: a weighted sum of terms and its total over the episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class WeightedSumManager(ManagerBase):
    """Adds ``weight * value * dt`` over its terms.

    A value that is not finite counts as zero: the world it comes from is being reset.
    """

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolves the terms and evaluates each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values()
        self._step_values = {name: torch.zeros(self.num_envs, device=self.device) for name in self._terms}
        self._episode_sums = {name: torch.zeros(self.num_envs, device=self.device) for name in self._terms}

    @property
    def step_values(self) -> dict[str, torch.Tensor]:
        """What each term added in the last step, shape (N,); they add up to the sum."""
        return self._step_values

    @property
    def episode_sums(self) -> dict[str, torch.Tensor]:
        """What each term added since the last reset of each world, shape (N,)."""
        return self._episode_sums

    def compute(self, dt: float) -> torch.Tensor:
        """Returns the sum over all terms.

        Args:
            dt: Factor of every value: the control step [s], or 1 to leave values as they are.

        Returns:
            Sum of each world, shape (N,).
        """
        total = torch.zeros(self.num_envs, device=self.device)
        for name, term in self._terms.items():
            if term.weight == 0.0:
                self._step_values[name] = torch.zeros_like(total)
                continue
            value = torch.nan_to_num(self._evaluate(name).float(), nan=0.0, posinf=0.0, neginf=0.0)
            value = value * (term.weight * dt)
            self._step_values[name] = value
            self._episode_sums[name] += value
            total += value
        return total

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Returns the mean episode sum of each term over some worlds, and starts them again from zero."""
        super().reset(env_ids)
        selected = slice(None) if env_ids is None else env_ids
        means = {name: total[selected].mean() for name, total in self._episode_sums.items()}
        for total in self._episode_sums.values():
            total[selected] = 0.0
        return means

    def _columns(self) -> list[str]:
        return ["index", "name", "weight"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.weight] for index, (name, term) in enumerate(self._terms.items())]
