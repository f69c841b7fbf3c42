# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures to report about episodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_cfg import MetricsTermCfg
from arcgym.utils.string import did_you_mean
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


REDUCTIONS = ("last", "max", "sum", "mean")
"""How a term may be reduced over the episode, in the order of the rows."""


class MetricsManager(ManagerBase):
    """Reduces each term over the episode and logs the mean over the worlds that end.

    Values stand in one row a term, sorted by reduction: each reduction is one operation on all its terms.
    """

    term_cfg_type = MetricsTermCfg

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolve the terms and evaluate each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values()
        self._order: list[str] = list(self._terms)
        self._values = torch.zeros(len(self._terms), self.num_envs, device=self.device)
        self._num_steps = torch.zeros(self.num_envs, device=self.device)
        self._step_values: dict[str, torch.Tensor] = {}
        self._finished = torch.zeros_like(self._values)
        self._sort_rows()

    @property
    def step_values(self) -> dict[str, torch.Tensor]:
        """Value of each term in the last step, shape (N,); empty before the first."""
        return self._step_values

    @property
    def finished(self) -> dict[str, torch.Tensor]:
        """Each term over the last episode that a world finished, shape (N,); zero before the first one."""
        return {name: self._finished[self._order.index(name)] for name in self._terms}

    def compute(self) -> None:
        """Take the values of this control step in; one that is not finite counts as zero, and is counted.

        The step in which the state of a world is no longer finite is left out: figures are those of the steps before.
        """
        if not self._terms:
            return
        self._sort_rows()
        is_first = self._num_steps == 0
        self._num_steps += 1
        by_name = {name: self._evaluate(name) for name in self._terms}
        values = self._finite_rows([by_name[name] for name in self._order])
        self._step_values = dict(zip(self._order, values, strict=True))
        past = self._values.clone()
        last, largest, added = self._rows_of("last"), self._rows_of("max"), self._rows_of("sum", "mean")
        means = self._rows_of("mean")
        self._values[last] = values[last]
        self._values[largest] = torch.where(is_first, values[largest], torch.maximum(past[largest], values[largest]))
        self._values[added] += values[added]
        past[means] += past[means] / (self._num_steps - 1).clamp(min=1)
        self._values.copy_(torch.where(self._env.sim.non_finite, past, self._values))

    @property
    def _value_names(self) -> list[str]:
        return self._order

    def get_value(self, name: str) -> torch.Tensor:
        """Return a term reduced over the episode so far, shape (N,)."""
        is_mean = self.get_term_cfg(name).reduce == "mean"
        self._sort_rows()
        value = self._values[self._order.index(name)]
        return value / self._num_steps.clamp(min=1) if is_mean else value

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Return the mean of each term over those of some worlds that made a step, and start them again."""
        super().reset(env_ids)
        self._sort_rows()
        selected = slice(None) if env_ids is None else env_ids
        steps = self._num_steps[selected]
        values = self._values.clone() if env_ids is None else self._values[:, env_ids]
        values[self._rows_of("mean")] /= steps.clamp(min=1)
        has_run = steps > 0
        means = (values * has_run).sum(dim=1) / has_run.sum().clamp(min=1)
        self._finished[:, selected] = torch.where(has_run, values, self._finished[:, selected])
        fill_worlds(self._values, env_ids, 0.0, dim=1)
        fill_worlds(self._num_steps, env_ids, 0.0)
        by_name = dict(zip(self._order, means, strict=True))
        return {f"Episode_Metrics/{name}": by_name[name] for name, term in self._terms.items() if term.log}

    def _sort_rows(self) -> None:
        """Sort the rows by reduction again if one was changed."""
        order = sorted(self._terms, key=self._place)
        if order != self._order:
            rows = [self._order.index(name) for name in order]
            self._values, self._finished = self._values[rows], self._finished[rows]
            self._order = order

    def _place(self, name: str) -> int:
        reduce = self._terms[name].reduce
        if reduce not in REDUCTIONS:
            raise ValueError(
                f"Term '{name}' of MetricsManager: no reduction '{reduce}'. {did_you_mean(reduce, REDUCTIONS)}"
            )
        return REDUCTIONS.index(reduce)

    def _rows_of(self, *reductions: str) -> slice:
        """Rows of the terms with reductions that stand side by side in :data:`REDUCTIONS`."""
        places = [self._place(name) for name in self._order]
        first = sum(place < REDUCTIONS.index(reductions[0]) for place in places)
        return slice(first, first + sum(REDUCTIONS[place] in reductions for place in places))

    def _columns(self) -> list[str]:
        return ["index", "name", "reduce"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.reduce] for index, (name, term) in enumerate(self._terms.items())]
