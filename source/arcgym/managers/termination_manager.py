# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Reasons to end episodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.sensor_use import may_read_sensors
from arcgym.managers.term_cfg import TerminationTermCfg
from arcgym.utils.errors import TermError

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class TerminationManager(ManagerBase):
    """Tells which worlds are done, and whether they were lost or ran out of time."""

    term_cfg_type = TerminationTermCfg

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolve the terms and evaluate each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values(torch.bool)
        self._dones = torch.zeros(len(self._terms), self.num_envs, dtype=torch.bool, device=self.device)
        self._order = self._sorted_names()
        self._terminated = self._none()
        self._time_outs = self._none()

    @property
    def reads_sensors(self) -> bool:
        """Whether some term may look at a sensor; see :func:`arcgym.managers.reads_no_sensor`."""
        return any(may_read_sensors(term.func) for term in self._terms.values())

    @property
    def dones(self) -> torch.Tensor:
        """Worlds whose episode ends, bool, shape (N,)."""
        return self._terminated | self._time_outs

    @property
    def terminated(self) -> torch.Tensor:
        """Worlds that came to an end of the task, bool, shape (N,)."""
        return self._terminated

    @property
    def time_outs(self) -> torch.Tensor:
        """Worlds that were cut short, bool, shape (N,)."""
        return self._time_outs

    @property
    def success(self) -> torch.Tensor:
        """Worlds that a term with ``success=True`` ended in the last step, bool, shape (N,); none without one."""
        rows = [self._dones[row] for row, name in enumerate(self._order) if self._terms[name].success]
        return torch.stack(rows).any(dim=0) if rows else self._none()

    def compute(self) -> torch.Tensor:
        """Evaluate all terms and return :attr:`dones`."""
        if self._terms:
            self._order = self._sorted_names()
            values = {name: self._evaluate(name) for name in self._terms}
            self._check_bool(values)
            self._dones = torch.stack([values[name] for name in self._order])
            first = sum(not term.time_out for term in self._terms.values())
            self._terminated, self._time_outs = self._dones[:first].any(dim=0), self._dones[first:].any(dim=0)
        return self.dones

    def get_term(self, name: str) -> torch.Tensor:
        """Return which worlds a term ended in the last step, bool, shape (N,)."""
        self.get_term_cfg(name)
        return self._dones[self._order.index(name)]

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Return how many of some worlds each term ended."""
        super().reset(env_ids)
        counts = (self._dones if env_ids is None else self._dones[:, env_ids]).sum(dim=1, dtype=torch.float32)
        by_name = dict(zip(self._order, counts, strict=True))
        return {f"Episode_Termination/{name}": by_name[name] for name in self._terms}

    def _check_bool(self, values: dict[str, torch.Tensor]) -> None:
        for name, value in values.items():
            if value.dtype != torch.bool:
                raise TermError(f"Term '{name}' of TerminationManager returned {value.dtype}, expected torch.bool.")

    def _sorted_names(self) -> list[str]:
        """Names of the terms, those that are no time-outs first: the rows of the flags."""
        return sorted(self._terms, key=lambda name: self._terms[name].time_out)

    def _none(self) -> torch.Tensor:
        return torch.zeros(self.num_envs, dtype=torch.bool, device=self.device)

    def _columns(self) -> list[str]:
        return ["index", "name", "time_out", "success"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.time_out, term.success] for index, (name, term) in enumerate(self._terms.items())]
