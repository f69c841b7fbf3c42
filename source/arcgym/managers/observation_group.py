# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One group of observations at run time: its terms, their pipelines, and how they are joined."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import torch

from arcgym.managers.buffers import DelayBuffer, FrameBuffer, Store
from arcgym.managers.term_base import ManagerTermBase
from arcgym.managers.term_cfg import ObservationGroupCfg, ObservationTermCfg
from arcgym.utils.errors import TermError
from arcgym.utils.worlds import finite

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

logger = logging.getLogger(__name__)


class ObservationPipeline:
    """A term's way from its function to the learner: noise, clip, scale, delay, history."""

    def __init__(self, label: str, cfg: ObservationTermCfg, group: ObservationGroupCfg, env: ManagerBasedEnv) -> None:
        """Evaluate the term once to learn its shape.

        Args:
            label: Group and term, for messages.
            cfg: Resolved configuration of the term.
            group: Configuration of its group.
            env: Environment it observes.

        Raises:
            TermError: If the value is no tensor, or integers meet noise or scale.
            ValueError: If the value's first dimension is not the worlds.
        """
        self.cfg = cfg
        self._env = env
        self._label = label
        self._noise = cfg.noise if group.enable_corruption else None
        self._nan_policy = group.nan_policy
        self._scale = None if cfg.scale is None else torch.as_tensor(cfg.scale, device=env.device)
        has_own_history = group.history_length is None
        length = cfg.history_length if has_own_history else group.history_length
        self._flattens = cfg.flatten_history_dim if has_own_history else group.flatten_history_dim
        self._history = FrameBuffer(length, env.num_envs, env.device) if length else None
        self._delay = self._make_delay() if cfg.delay_max_lag > 0 else None
        self._check(cfg.func(env, **cfg.params))
        sample = self.compute(store=False)
        self.shape = tuple(sample.shape[1:])
        self.dtype = sample.dtype
        self.reset(slice(None))

    @property
    def is_plain(self) -> bool:
        """Whether nothing but the group's policy for values that are not finite lies between function and learner."""
        steps = (self._noise, self.cfg.clip, self._scale, self._delay, self._history)
        is_sanitized = self._nan_policy == "sanitize" or not self.dtype.is_floating_point
        return is_sanitized and all(step is None for step in steps)

    def read(self) -> torch.Tensor:
        """Return what the term's function returns, shape (N, ...); it may be memory that the next step overwrites."""
        return self.cfg.func(self._env, **self.cfg.params)

    def compute(self, store: Store = True) -> torch.Tensor:
        """Return the observation in memory that no later step writes to, shape (N, ...).

        Integers, as of images, are copied once: into the history where there is one, else into the result.

        Args:
            store: Whether delay and history take the value in, or the worlds where they do.
        """
        value = self.read()
        is_copied = value.is_floating_point()
        if is_copied:
            value = self._finite(value)
        if self._noise is not None:
            value = self._noise.apply(value, self._env.random, self._label)
        if self.cfg.clip is not None:
            value, is_copied = value.clamp(*self.cfg.clip), True
        if self._scale is not None:
            value = value * self._scale
        if self._delay is not None:
            value, is_copied = self._delay.append(value, store), True
        if self._history is not None:
            value = self._history.append(value, store)
            return value.flatten(1, 2) if self._flattens else value
        return value if is_copied else value.clone(memory_format=torch.contiguous_format)

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Forget the past of some worlds."""
        for buffer in (self._delay, self._history):
            if buffer is not None:
                buffer.reset(env_ids)
        if isinstance(self.cfg.func, ManagerTermBase):
            self.cfg.func.reset(None if isinstance(env_ids, slice) else env_ids)

    def _make_delay(self) -> DelayBuffer:
        return DelayBuffer(
            (self.cfg.delay_min_lag, self.cfg.delay_max_lag),
            self._env.num_envs,
            self._env.device,
            self._env.random,
            tag=f"{self._label}: delay",
            per_env=self.cfg.delay_per_env,
            hold_prob=self.cfg.delay_hold_prob,
            update_period=self.cfg.delay_update_period,
        )

    def _check(self, value: torch.Tensor) -> None:
        if not isinstance(value, torch.Tensor):
            raise TermError(f"{self._label} returned {type(value).__name__}, expected a tensor.")
        if value.dim() < 2 or value.shape[0] != self._env.num_envs:
            raise ValueError(
                f"{self._label} returned shape {tuple(value.shape)}, expected ({self._env.num_envs}, ...) "
                "with at least one dimension after the worlds."
            )
        if not value.is_floating_point() and (self._noise is not None or self._scale is not None):
            raise TermError(f"{self._label} returned {value.dtype}: noise and scale need floating point values.")

    def _finite(self, value: torch.Tensor) -> torch.Tensor:
        """Apply the group's policy to values that are not finite, in new memory."""
        if self._nan_policy == "sanitize":
            return finite(value)
        if self._nan_policy in ("warn", "error") and not bool(torch.isfinite(value).all()):
            message = f"{self._label} returned values that are not finite."
            if self._nan_policy == "error":
                raise ValueError(message)
            logger.warning(message)
        return value.clone()


class ObservationGroup:
    """Terms that go to the learner together."""

    def __init__(
        self, name: str, cfg: ObservationGroupCfg, terms: dict[str, ObservationTermCfg], env: ManagerBasedEnv
    ) -> None:
        """Make the pipelines and check that they can be joined.

        Args:
            name: Name of the group.
            cfg: Configuration of the group.
            terms: Its resolved terms by name.
            env: Environment they observe.

        Raises:
            ValueError: If terms cannot be concatenated, naming both.
        """
        self.name = name
        self.cfg = cfg
        self.pipelines = {
            term: ObservationPipeline(f"Term '{term}' of observation group '{name}'", term_cfg, cfg, env)
            for term, term_cfg in terms.items()
        }
        self._dim = cfg.concatenate_dim if cfg.concatenate_dim < 0 else cfg.concatenate_dim + 1
        if cfg.concatenate_terms:
            self._check_concatenation()

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of each term without the worlds."""
        return {name: pipeline.shape for name, pipeline in self.pipelines.items()}

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the concatenated group without the worlds."""
        shapes = list(self.shapes.values())
        joined = list(shapes[0])
        joined[self.cfg.concatenate_dim] = sum(shape[self.cfg.concatenate_dim] for shape in shapes)
        return tuple(joined)

    def compute(self, store: Store = True) -> torch.Tensor | dict[str, torch.Tensor]:
        """Return the group: one tensor, shape (N, ...), or a dict of them."""
        pipelines = self.pipelines.values()
        if self.cfg.concatenate_terms and all(pipeline.is_plain for pipeline in pipelines):
            return self._join([pipeline.read() for pipeline in pipelines])
        values = {name: pipeline.compute(store) for name, pipeline in self.pipelines.items()}
        if not self.cfg.concatenate_terms:
            return values
        tensors = list(values.values())
        return tensors[0] if len(tensors) == 1 else torch.cat(tensors, dim=self._dim)

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Forget the past of some worlds."""
        for pipeline in self.pipelines.values():
            pipeline.reset(env_ids)

    def _join(self, values: list[torch.Tensor]) -> torch.Tensor:
        """Return plain values side by side in new, contiguous memory; what is not finite becomes zero."""
        if values[0].is_floating_point():
            return finite(torch.cat(values, dim=self._dim))
        joined = torch.empty((len(values[0]), *self.shape), dtype=values[0].dtype, device=values[0].device)
        return torch.cat(values, dim=self._dim, out=joined)

    def _check_concatenation(self) -> None:
        """Compare each term with the first: same type, same shape but for the joined dimension."""
        first_name, first = next(iter(self.pipelines.items()))
        dim = self.cfg.concatenate_dim
        if not -len(first.shape) <= dim < len(first.shape):
            raise ValueError(f"Observation group '{self.name}' has concatenate_dim {dim} for the shape {first.shape}.")
        for name, other in self.pipelines.items():
            if _without(first.shape, dim) != _without(other.shape, dim) or first.dtype != other.dtype:
                raise ValueError(
                    f"Observation group '{self.name}' cannot concatenate '{first_name}' {first.shape} {first.dtype} "
                    f"and '{name}' {other.shape} {other.dtype} along dimension {dim}: give them groups of their own "
                    "or set concatenate_terms=False."
                )


def _without(shape: tuple[int, ...], dim: int) -> tuple[int, list[int]]:
    rest = list(shape)
    if -len(rest) <= dim < len(rest):
        del rest[dim]
    return len(shape), rest
