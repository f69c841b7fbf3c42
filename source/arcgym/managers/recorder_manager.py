# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Recording of episodes to files."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.recorder_buffer import EpisodeBuffer, Values
from arcgym.managers.recorder_cfg import RecorderManagerBaseCfg, RecorderTermCfg
from arcgym.managers.recorder_files import Episode, next_path
from arcgym.managers.recorder_term import RecorderTerm
from arcgym.managers.term_resolver import collect_terms
from arcgym.utils.string import resolve_callable

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

logger = logging.getLogger(__name__)


class RecorderManager(ManagerBase):
    """Collects what its terms answer, and writes each episode to a file of its own when it ends.

    Every step copies the recorded values to the host, for which it waits for the device. Without terms, or with
    ``dataset_export_mode="none"``, no method does anything.
    """

    term_cfg_type = RecorderTermCfg

    def __init__(self, cfg: RecorderManagerBaseCfg | None, env: ManagerBasedEnv) -> None:
        """Construct the terms.

        Raises:
            TypeError: If ``cfg`` is no recorder configuration or a member is not a recorder term.
            IndexError: If a world to record does not exist.
        """
        if cfg is not None and not isinstance(cfg, RecorderManagerBaseCfg):
            raise TypeError(f"recorders is of type {type(cfg).__name__}, expected a RecorderManagerBaseCfg or None.")
        super().__init__(cfg, env)
        self._settings = cfg or RecorderManagerBaseCfg(dataset_export_mode="none")
        self._worlds = list(range(env.num_envs)) if self._settings.env_ids is None else list(self._settings.env_ids)
        if any(not 0 <= world < env.num_envs for world in self._worlds):
            raise IndexError(f"Recorder env_ids are {self._worlds}; worlds go from 0 to {env.num_envs - 1}.")
        self._place = {world: place for place, world in enumerate(self._worlds)}
        self._buffer = EpisodeBuffer(len(self._worlds))
        self.num_exported = 0
        """Episodes written by this manager."""

    @property
    def active(self) -> bool:
        """Whether anything is recorded."""
        return bool(self._terms) and self._settings.dataset_export_mode != "none"

    def record_pre_step(self) -> None:
        """Open a step: the action is known, nothing has moved yet."""
        if self.active:
            self._buffer.drop_step()
            self._record_step(lambda term: term.record_pre_step())

    def record_post_step(self) -> None:
        """Close a step: rewards and terminations are known, no world has been reset yet."""
        if self.active:
            self._record_step(lambda term: term.record_post_step())
            self._buffer.end_step()

    def record_pre_reset(self, env_ids: torch.Tensor) -> None:
        """End the episodes of the worlds ``env_ids``, int64, shape (n,), and write them."""
        if self.active:
            worlds = self._record_once(env_ids, lambda term, ids: term.record_pre_reset(ids))
            self._export(worlds)

    def record_post_reset(self, env_ids: torch.Tensor) -> None:
        """Start the episodes of the worlds ``env_ids``, int64, shape (n,)."""
        if self.active:
            self._record_once(env_ids, lambda term, ids: term.record_post_reset(ids))

    def close(self) -> None:
        """Write the episodes under way as incomplete ones. A step that failed half-way is not among theirs."""
        if self.active:
            self._buffer.drop_step()
            self._export(self._worlds)

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Do nothing: episodes end in :meth:`record_pre_reset`."""
        return {}

    def set_term_cfg(self, name: str, cfg: Any) -> None:
        """Raise: what is recorded is fixed at construction."""
        raise TypeError(f"The recorder term '{name}' cannot be replaced: what is recorded is fixed at construction.")

    def _prepare_terms(self) -> dict[str, Any]:
        settings = [field.name for field in dataclasses.fields(RecorderManagerBaseCfg)]
        terms = collect_terms(self.cfg, self.term_cfg_type, type(self).__name__, skip=settings)
        return {name: self._construct(name, term) for name, term in terms.items()}

    def _construct(self, name: str, cfg: RecorderTermCfg) -> RecorderTerm:
        kind = resolve_callable(cfg.class_type) if isinstance(cfg.class_type, str) else cfg.class_type
        if not (isinstance(kind, type) and issubclass(kind, RecorderTerm)):
            raise TypeError(f"Term '{name}' of RecorderManager has class_type {kind}, expected a RecorderTerm.")
        return kind(cfg, self._env)

    def _record_step(self, ask: Callable[[RecorderTerm], tuple[str | None, Any]]) -> None:
        for term in self._terms.values():
            values = _flatten(*ask(term))
            if self._settings.env_ids is not None:
                values = {name: value[self._worlds] for name, value in values.items()}
            self._buffer.add(_to_host(values))

    def _record_once(
        self, env_ids: torch.Tensor, ask: Callable[[RecorderTerm, torch.Tensor], tuple[str | None, Any]]
    ) -> list[int]:
        """Store answers about some worlds, and return those of them that are recorded."""
        worlds = [world for world in env_ids.tolist() if world in self._place]
        if worlds:
            ids = torch.tensor(worlds, device=self.device)
            for term in self._terms.values():
                self._buffer.add_once([self._place[w] for w in worlds], _to_host(_flatten(*ask(term, ids))))
        return worlds

    def _export(self, worlds: list[int]) -> None:
        """Write the episodes of some worlds; those without a step are dropped."""
        for world in worlds:
            length = self._buffer.length(self._place[world])
            data = self._buffer.take(self._place[world])
            info = {"length": length, "step_dt": self._env.step_dt, "env_id": world, **self._info(world)}
            if length == 0 or (self._settings.dataset_export_mode == "succeeded_only" and not info["success"]):
                continue
            path = next_path(self._settings.dataset_export_dir_path, self._settings.dataset_filename)
            Episode(data, info).save(path)
            self.num_exported += 1
            logger.info("recorded %d steps of world %d: %s", length, world, path)

    def _info(self, world: int) -> dict[str, Any]:
        """How the episode of a world stands, from the environment's other managers."""
        judge, metrics = getattr(self._env, "termination_manager", None), getattr(self._env, "metrics_manager", None)
        ended_by = [name for name in judge.active_terms if bool(judge.get_term(name)[world])] if judge else []
        flags = {"terminated": "reset_terminated", "time_out": "reset_time_outs"}
        done = {name: bool(getattr(self._env, flag)[world]) for name, flag in flags.items()} if judge else {}
        figures = {name: float(metrics.get_value(name)[world]) for name in metrics.active_terms} if metrics else {}
        return {
            "complete": any(done.values()),
            "success": bool(judge.success[world]) if judge else False,
            **done,
            "ended_by": ended_by,
            "metrics": figures,
        }

    def _columns(self) -> list[str]:
        return ["index", "name", "class"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, type(term).__name__] for index, (name, term) in enumerate(self._terms.items())]


def _flatten(name: str | None, value: Any) -> dict[str, torch.Tensor]:
    """Tensors of a nested dict by path; nothing for None."""
    if name is None or value is None:
        return {}
    if not isinstance(value, dict):
        return {name: value}
    return {path: leaf for key, child in value.items() for path, leaf in _flatten(f"{name}/{key}", child).items()}


def _to_host(values: dict[str, torch.Tensor]) -> Values:
    return {name: np.ascontiguousarray(value.detach().to("cpu", copy=True).numpy()) for name, value in values.items()}
