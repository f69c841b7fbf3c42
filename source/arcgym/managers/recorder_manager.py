# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Recording of episodes to files."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.recorder_buffer import EpisodeBuffer, Values
from arcgym.managers.recorder_cfg import RecorderManagerBaseCfg, RecorderTermCfg
from arcgym.managers.recorder_chunks import pack_together
from arcgym.managers.recorder_files import claim_path
from arcgym.managers.recorder_term import RecorderTerm
from arcgym.managers.recorder_writer import EpisodeWriter, allow_files
from arcgym.managers.term_resolver import collect_terms
from arcgym.utils.errors import TermError
from arcgym.utils.string import resolve_callable

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

logger = logging.getLogger(__name__)


class RecorderManager(ManagerBase):
    """Collects what its terms answer, and writes each episode to a file of its own, every second of it as it comes.

    Every step copies the recorded values to the host, for which it waits for the device. Without terms, or with
    ``dataset_export_mode="none"``, no method does anything.
    """

    term_cfg_type = RecorderTermCfg

    def __init__(self, cfg: RecorderManagerBaseCfg | None, env: ManagerBasedEnv) -> None:
        """Construct the terms.

        Raises:
            TermError: If ``cfg`` is no recorder configuration or a member is not a recorder term.
            IndexError: If a world to record does not exist.
            ValueError: If so many files cannot be open at a time.
        """
        if cfg is not None and not isinstance(cfg, RecorderManagerBaseCfg):
            raise TermError(f"recorders is of type {type(cfg).__name__}, expected a RecorderManagerBaseCfg or None.")
        super().__init__(cfg, env)
        self._settings = cfg or RecorderManagerBaseCfg(dataset_export_mode="none")
        chosen = self._settings.env_ids
        self._worlds = list(range(env.num_envs) if chosen is None else dict.fromkeys(chosen))
        if any(not 0 <= world < env.num_envs for world in self._worlds):
            raise IndexError(f"Recorder env_ids are {self._worlds}; worlds go from 0 to {env.num_envs - 1}.")
        self._place = {world: place for place, world in enumerate(self._worlds)}
        self._buffer = EpisodeBuffer(len(self._worlds))
        self._writers: dict[int, EpisodeWriter] = {}
        self._chunk = max(1, round(1.0 / env.step_dt))
        if self.active:
            allow_files(len(self._worlds))
        self._ignored: frozenset[int] = frozenset()
        self.notes: dict[str, Any] = {}
        """Further facts for ``info`` of the episodes that end from now on: plain values by name."""
        self.paths: list[Path] = []
        """Episodes written by this manager."""
        self._disk_failed = False

    @property
    def num_exported(self) -> int:
        """Number of episodes written by this manager."""
        return len(self.paths)

    @property
    def active(self) -> bool:
        """Whether anything is recorded."""
        return bool(self._terms) and self._settings.dataset_export_mode != "none"

    def length(self, world: int) -> int:
        """Return the steps recorded of the episode under way in a world."""
        written = self._writers[world].length if world in self._writers else 0
        return written + self._buffer.length(self._place[world])

    def shorten(self, world: int, length: int) -> None:
        """Keep the first ``length`` steps of the episode under way alone, as after an undo.

        Raises:
            ValueError: If more than one world is recorded: their steps are kept together.
        """
        waiting = self._buffer.length(self._place[world])
        self._buffer.shorten(self._place[world], min(waiting, self.length(world) - length))
        if world in self._writers:
            self._writers[world].shorten(length)

    def ignore(self, worlds: Iterable[int]) -> None:
        """Record nothing of some worlds until the next call, and drop what they have under way."""
        self._ignored = frozenset(worlds) & self._place.keys()
        for world in self._ignored:
            self._buffer.take(self._place[world])
            self._buffer.take_once(self._place[world])
            if world in self._writers:
                self._writers.pop(world).discard()

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
            for world in self._ignored:
                self._buffer.take(self._place[world])
            self._write([world for world in self._worlds if self._buffer.length(self._place[world]) >= self._chunk])

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
        """Write the episodes under way as incomplete ones. A step that failed half-way is not among theirs.

        Where the disk has failed they stay as after a kill: ending a file takes room, and half ended none can be read.
        """
        if not self.active or self._disk_failed:
            return
        if not self._buffer.is_open:
            under_way = [world for world in self._worlds if self.length(world)]
            self._record_once(torch.tensor(under_way), lambda term, ids: term.record_pre_reset(ids))
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
            raise TermError(f"Term '{name}' of RecorderManager has class_type {kind}, expected a RecorderTerm.")
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
        worlds = [world for world in env_ids.tolist() if world in self._place and world not in self._ignored]
        if worlds:
            ids = torch.tensor(worlds, device=self.device)
            for term in self._terms.values():
                self._buffer.add_once([self._place[w] for w in worlds], _to_host(_flatten(*ask(term, ids))))
        return worlds

    def _write(self, worlds: Sequence[int]) -> None:
        """Hand the steps that wait over to the files; the first ones make them."""
        handed = [self._buffer.take(self._place[world]) for world in worlds]
        chunks = pack_together(
            [steps if self._begins_chunk(world) else {} for world, steps in zip(worlds, handed, strict=True)],
            self._chunk,
        )
        for world, steps, packed in zip(worlds, handed, chunks, strict=True):
            once = {} if world in self._writers else self._buffer.take_once(self._place[world])
            try:
                self._writer(world).append(steps, once, packed)
            except OSError:
                self._disk_failed = True
                raise

    def _begins_chunk(self, world: int) -> bool:
        return world not in self._writers or self._writers[world].begins_chunk

    def _writer(self, world: int) -> EpisodeWriter:
        """Return the writer of a world's episode; its file appears with the first steps."""
        if world not in self._writers:
            facts, settings = self._env.provenance(world)
            path = claim_path(self._settings.dataset_export_dir_path, self._settings.dataset_filename)
            self._writers[world] = EpisodeWriter(path, facts | {"env_id": world}, settings, self._chunk)
        return self._writers[world]

    def _export(self, worlds: list[int]) -> None:
        """Finish the episodes of some worlds; those without a step are dropped."""
        self._write([world for world in worlds if self._buffer.length(self._place[world])])
        for world in worlds:
            once = self._buffer.take_once(self._place[world])
            writer = self._writers.pop(world, None)
            if writer is None:
                continue
            info = {"length": writer.length, "step_dt": self._env.step_dt, "env_id": world}
            info |= {**self._env.episode_facts(world), **self._info(world), **self.notes}
            if writer.length == 0 or (self._settings.dataset_export_mode == "succeeded_only" and not info["success"]):
                writer.discard()
                continue
            self.paths.append(writer.finish(once, info))
            logger.info("recorded %d steps of world %d: %s", writer.length, world, writer.path)

    def _info(self, world: int) -> dict[str, Any]:
        """How the episode of a world stands, from the environment's other managers."""
        env: Any = self._env
        judge, metrics = getattr(env, "termination_manager", None), getattr(env, "metrics_manager", None)
        ended_by = [name for name in judge.active_terms if bool(judge.get_term(name)[world])] if judge else []
        flags = {"terminated": "reset_terminated", "time_out": "reset_time_outs"}
        done = {name: bool(getattr(self._env, flag)[world]) for name, flag in flags.items()} if judge else {}
        figures = {name: float(metrics.get_value(name)[world]) for name in metrics.active_terms} if metrics else {}
        return {
            "complete": any(done.values()),
            "success": bool(env.succeeded[world]) if judge else False,
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
