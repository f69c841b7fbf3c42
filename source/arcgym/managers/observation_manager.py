# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Observations, in groups."""

from __future__ import annotations

import dataclasses
from typing import Any

import torch

from arcgym.managers.buffers import Store
from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.observation_group import ObservationGroup
from arcgym.managers.term_cfg import ObservationGroupCfg, ObservationTermCfg
from arcgym.managers.term_resolver import collect_terms, resolve_term

Observation = torch.Tensor | dict[str, torch.Tensor]
"""A group's value: one tensor, shape (N, ...), or one for each term."""


class ObservationManager(ManagerBase):
    """Computes every observation group of the environment."""

    term_cfg_type = ObservationGroupCfg
    unit = "groups"

    def __str__(self) -> str:
        """List groups and terms with shapes and types."""
        return "\n".join([super().__str__(), *self._term_lines()])

    @property
    def active_terms(self) -> dict[str, list[str]]:  # type: ignore[override]
        """Names of the terms of each group."""
        return {name: list(group.pipelines) for name, group in self.groups.items()}

    @property
    def group_obs_dim(self) -> dict[str, tuple[int, ...] | dict[str, tuple[int, ...]]]:
        """Shape of each group without the worlds; one for each term where they are not concatenated."""
        return {
            name: group.shape if group.cfg.concatenate_terms else group.shapes for name, group in self.groups.items()
        }

    def compute(self, update_history: Store = True) -> dict[str, Observation]:
        """Return all groups, in memory that no later call writes to: they may be kept, but not written to.

        Args:
            update_history: Whether delays and histories take the values in, or the indices of the worlds where they
                do, int64, shape (n,). Set once a control step; False looks without leaving a trace, as for final
                observations.
        """
        return {name: group.compute(update_history) for name, group in self.groups.items()}

    def compute_group(self, name: str, update_history: Store = False) -> Observation:
        """Return one group; see :meth:`compute`."""
        self.get_term_cfg(name)
        return self.groups[name].compute(update_history)

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Empty delays and histories of some worlds."""
        for group in self.groups.values():
            group.reset(slice(None) if env_ids is None else env_ids)
        return {}

    def set_term_cfg(self, name: str, cfg: Any) -> None:
        """Raise: the shapes of observations are fixed at construction."""
        raise TypeError(f"The observation group '{name}' cannot be replaced: its shape is fixed at construction.")

    def _prepare_terms(self) -> dict[str, Any]:
        owner = type(self).__name__
        settings = {field.name for field in dataclasses.fields(ObservationGroupCfg)}
        cfgs = collect_terms(self.cfg, ObservationGroupCfg, owner)
        self.groups: dict[str, ObservationGroup] = {}
        for name, cfg in cfgs.items():
            owner = f"the observation group '{name}'"
            terms = collect_terms(cfg, ObservationTermCfg, owner, skip=settings)
            terms |= collect_terms(cfg.terms, ObservationTermCfg, owner)
            if not terms:
                raise ValueError(f"The observation group '{name}' has no terms: add one or set the group to None.")
            for term, term_cfg in terms.items():
                resolve_term(term_cfg, self._env, term, owner, self.leading_arguments)
            self.groups[name] = ObservationGroup(name, cfg, terms, self._env)
        return cfgs

    def _columns(self) -> list[str]:
        return ["index", "group", "shape"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, shape] for index, (name, shape) in enumerate(self.group_obs_dim.items())]

    def _term_lines(self) -> list[str]:
        return [
            f"  {group.name}.{name}: {pipeline.shape} {pipeline.dtype}"
            for group in self.groups.values()
            for name, pipeline in group.pipelines.items()
        ]
