# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rules that change the task as training goes on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_cfg import CurriculumTermCfg

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class CurriculumManager(ManagerBase):
    """Calls its terms at resets, before the worlds are set up again."""

    term_cfg_type = CurriculumTermCfg
    leading_arguments = ("env", "env_ids")

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolve the terms; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._states: dict[str, Any] = dict.fromkeys(self._terms)

    def compute(self, env_ids: torch.Tensor) -> None:
        """Call every term with the worlds that are about to be reset.

        Args:
            env_ids: World indices, int64, shape (n,).
        """
        for name, term in self._terms.items():
            self._states[name] = term.func(self._env, env_ids, **term.params)

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Return what the terms answered last."""
        super().reset(env_ids)
        logs: dict[str, Any] = {}
        for name, state in self._states.items():
            if isinstance(state, dict):
                logs |= {f"Curriculum/{name}/{key}": value for key, value in state.items()}
            elif state is not None:
                logs[f"Curriculum/{name}"] = state
        return logs
