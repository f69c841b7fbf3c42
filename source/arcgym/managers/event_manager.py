# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes of the scene: at start-up, at resets, and now and then."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_cfg import EventTermCfg
from arcgym.utils.string import did_you_mean
from arcgym.utils.transfer import send

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class EventManager(ManagerBase):
    """Applies its terms by mode.

    Timers and step counts live on the CPU: which worlds are due is known without waiting for the device.
    Only a reset needs its world indices on the CPU, where the environment has just waited for them.
    """

    term_cfg_type = EventTermCfg
    leading_arguments = ("env", "env_ids")
    modes: ClassVar[tuple[str, ...]] = ("startup", "reset", "interval")

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Resolve the terms and start the interval timers; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._time_left: dict[str, torch.Tensor] = {}
        self._last_step: dict[str, torch.Tensor] = {}
        for name, term in self._terms.items():
            if term.mode not in self.modes:
                raise ValueError(
                    f"Term '{name}' of EventManager: no mode '{term.mode}'. {did_you_mean(term.mode, self.modes)}"
                )
            if term.mode == "interval":
                self._time_left[name] = self._draw(name, torch.arange(1 if term.is_global_time else self.num_envs))
            if term.mode == "reset" and term.min_step_count_between_reset > 0:
                self._last_step[name] = torch.full((self.num_envs,), -term.min_step_count_between_reset)

    def mode_terms(self, mode: str) -> list[str]:
        """Return the names of the terms of a mode."""
        return [name for name, term in self._terms.items() if term.mode == mode]

    def apply(
        self,
        mode: str,
        env_ids: torch.Tensor | None = None,
        dt: float | None = None,
        global_env_step_count: int | None = None,
    ) -> None:
        """Apply the terms of a mode.

        Args:
            mode: ``startup``, ``reset`` or ``interval``.
            env_ids: World indices, int64, shape (n,); None for all. Intervals choose their own.
            dt: Time since the last call [s]; needed by intervals.
            global_env_step_count: Control steps since the environment was made; needed by resets.

        Raises:
            ValueError: If what the mode needs is not given.
        """
        if (mode == "interval" and dt is None) or (mode == "reset" and global_env_step_count is None):
            raise ValueError(f"EventManager mode '{mode}' needs {'dt' if dt is None else 'global_env_step_count'}.")
        for name in self.mode_terms(mode):
            if name in self._time_left:
                selected = self._due(name, dt or 0.0)
            else:
                selected = torch.arange(self.num_envs, device=self.device) if env_ids is None else env_ids
            if name in self._last_step:
                selected = self._rested(name, selected, global_env_step_count or 0)
            if len(selected) > 0:
                term = self._terms[name]
                term.func(self._env, selected, **term.params)

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Start the interval timers of some worlds again, but for global ones."""
        super().reset(env_ids)
        for name, time_left in self._time_left.items():
            if not self._terms[name].is_global_time:
                selected = torch.arange(self.num_envs) if env_ids is None else self._env.host_ids(env_ids)
                time_left[selected] = self._draw(name, selected)
        return {}

    def _due(self, name: str, dt: float) -> torch.Tensor:
        """Advance a timer and return the worlds for which it ran out."""
        time_left = self._time_left[name]
        time_left -= dt
        is_due = time_left < 1e-6
        due = is_due.nonzero().flatten()
        time_left[due] = self._draw(name, due)
        if self._terms[name].is_global_time and len(due) > 0:
            due = torch.arange(self.num_envs)
        return send(due, self.device)

    def _rested(self, name: str, env_ids: torch.Tensor, step: int) -> torch.Tensor:
        """Return those of some worlds whose last event is long enough ago, and note the step for them."""
        last, ids = self._last_step[name], self._env.host_ids(env_ids)
        ids = ids[step - last[ids] >= self._terms[name].min_step_count_between_reset]
        last[ids] = step
        return send(ids, self.device)

    def _draw(self, name: str, worlds: torch.Tensor) -> torch.Tensor:
        """Return the times until the next events of some worlds [s], on the CPU as the indices; (n,)."""
        limits = self._terms[name].interval_range_s
        if limits is None:
            raise ValueError(f"Term '{name}' of EventManager has mode 'interval': interval_range_s must be given.")
        drawn = self._env.random.uniform(f"interval of {name}", env_ids=worlds, on_cpu=True)
        return limits[0] + (limits[1] - limits[0]) * drawn

    def _columns(self) -> list[str]:
        return ["index", "name", "mode"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.mode] for index, (name, term) in enumerate(self._terms.items())]
