# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures to report about episodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_cfg import MetricsTermCfg

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class MetricsManager(ManagerBase):
    """Reduces each term over the episode and logs the mean over the worlds that end."""

    term_cfg_type = MetricsTermCfg

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolves the terms and evaluates each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values()
        self._values = {name: torch.zeros(self.num_envs, device=self.device) for name in self._terms}
        self._num_steps = torch.zeros(self.num_envs, device=self.device)

    def compute(self) -> None:
        """Takes the values of this control step in; one that is not finite counts as zero."""
        is_first = self._num_steps == 0
        self._num_steps += 1
        for name, term in self._terms.items():
            value = torch.nan_to_num(self._evaluate(name).float(), nan=0.0, posinf=0.0, neginf=0.0)
            past = self._values[name]
            if term.reduce == "last":
                past.copy_(value)
            elif term.reduce == "max":
                past.copy_(torch.where(is_first, value, torch.maximum(past, value)))
            else:
                past.add_(value)

    def get_value(self, name: str) -> torch.Tensor:
        """Returns a term reduced over the episode so far, shape (N,)."""
        is_mean = self.get_term_cfg(name).reduce == "mean"
        return self._values[name] / self._num_steps.clamp(min=1) if is_mean else self._values[name]

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Returns the mean of each term over those of some worlds that made a step, and starts them again."""
        super().reset(env_ids)
        selected = slice(None) if env_ids is None else env_ids
        has_run = (self._num_steps[selected] > 0).float()
        count = has_run.sum().clamp(min=1)
        logs = {
            f"Episode_Metrics/{name}": (self.get_value(name)[selected] * has_run).sum() / count for name in self._terms
        }
        for value in (*self._values.values(), self._num_steps):
            value[selected] = 0.0
        return logs

    def _columns(self) -> list[str]:
        return ["index", "name", "reduce"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.reduce] for index, (name, term) in enumerate(self._terms.items())]
