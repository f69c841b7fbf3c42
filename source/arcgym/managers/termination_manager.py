# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Reasons to end episodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_cfg import TerminationTermCfg

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class TerminationManager(ManagerBase):
    """Tells which worlds are done, and whether they were lost or ran out of time."""

    term_cfg_type = TerminationTermCfg

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolves the terms and evaluates each once; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._check_values(torch.bool)
        self._term_dones = {name: self._none() for name in self._terms}
        self._terminated = self._none()
        self._time_outs = self._none()

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

    def compute(self) -> torch.Tensor:
        """Evaluates all terms and returns :attr:`dones`."""
        self._terminated = self._none()
        self._time_outs = self._none()
        for name, term in self._terms.items():
            value = self._evaluate(name)
            self._term_dones[name] = value.clone()
            if term.time_out:
                self._time_outs = self._time_outs | value
            else:
                self._terminated = self._terminated | value
        return self.dones

    def get_term(self, name: str) -> torch.Tensor:
        """Returns which worlds a term ended in the last step, bool, shape (N,)."""
        self.get_term_cfg(name)
        return self._term_dones[name]

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, torch.Tensor]:
        """Returns how many of some worlds each term ended."""
        super().reset(env_ids)
        selected = slice(None) if env_ids is None else env_ids
        return {f"Episode_Termination/{name}": done[selected].sum().float() for name, done in self._term_dones.items()}

    def _none(self) -> torch.Tensor:
        return torch.zeros(self.num_envs, dtype=torch.bool, device=self.device)

    def _columns(self) -> list[str]:
        return ["index", "name", "time_out"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.time_out] for index, (name, term) in enumerate(self._terms.items())]
