# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rings of past observations, one a world."""

from __future__ import annotations

import torch

from arcgym.utils.world_random import WorldRandom
from arcgym.utils.worlds import fill_worlds

Store = bool | torch.Tensor
"""Whether a buffer takes a value in: all worlds, none, or those whose indices (int64, shape (n,)) are given."""


class FrameBuffer:
    """Keeps the last frames of every world; the first frame after a reset fills them all.

    Every result is new memory that is read once more, to be shifted into the next: it may be kept and must not be
    written to. A frame is copied straight from the memory of whoever made it, in whatever order its strides have.
    """

    def __init__(self, length: int, num_envs: int, device: str) -> None:
        """Make an empty buffer.

        Args:
            length: Number of frames L.
            num_envs: Number of worlds N.
            device: Device of the frames.
        """
        self._length = length
        self._frames: torch.Tensor | None = None
        self._worlds = torch.arange(num_envs, device=device)
        self._empty = [self._worlds]

    def append(self, value: torch.Tensor, store: Store = True) -> torch.Tensor:
        """Return the frames with ``value`` as the newest, oldest first.

        Args:
            value: Newest frame, shape (N, ...).
            store: Whether to keep it, or the worlds that do; otherwise the buffer stays as it was.

        Returns:
            Frames, shape (N, L, ...).
        """
        frames = torch.empty((value.shape[0], self._length, *value.shape[1:]), dtype=value.dtype, device=value.device)
        frames[:, -1] = value
        if self._frames is not None:
            frames[:, :-1] = self._frames[:, 1:]
        for worlds in self._empty:
            frames[worlds] = value[worlds].unsqueeze(1)
        self._keep(frames, store)
        return frames

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Empty the buffers of some worlds."""
        self._empty.append(env_ids if isinstance(env_ids, torch.Tensor) else self._worlds[env_ids])

    def _keep(self, frames: torch.Tensor, store: Store) -> None:
        """Take the frames of all worlds or of some as the new past."""
        if isinstance(store, torch.Tensor):
            past = frames.clone() if self._frames is None else self._frames.clone()
            past[store] = frames[store]
            self._frames = past
            self._empty = [worlds[~torch.isin(worlds, store)] for worlds in self._empty]
        elif store:
            self._frames = frames
            self._empty = []


class DelayBuffer:
    """Hands out observations some control steps late."""

    def __init__(
        self,
        lag_range: tuple[int, int],
        num_envs: int,
        device: str,
        random: WorldRandom,
        *,
        tag: str = "delay",
        per_env: bool = True,
        hold_prob: float = 0.0,
        update_period: int = 0,
    ) -> None:
        """Draw the first lags.

        Args:
            lag_range: Smallest and largest lag [control steps].
            num_envs: Number of worlds N.
            device: Device of the observations.
            random: Random numbers of the worlds.
            tag: What the lags are for, to draw with.
            per_env: Whether each world draws its own lag.
            hold_prob: Probability of keeping the lag when a new one is due.
            update_period: Control steps between new lags; zero draws one each step.
        """
        if not 0 <= lag_range[0] <= lag_range[1]:
            raise ValueError(f"Delay lags must satisfy 0 <= min <= max, got {lag_range}.")
        self._lag_range = lag_range
        self._num_envs = num_envs
        self._random = random
        self._tag = tag
        self._per_env = per_env
        self._hold_prob = hold_prob
        self._period = max(update_period, 1)
        self._frames = FrameBuffer(lag_range[1] + 1, num_envs, device)
        self._age = torch.zeros(num_envs, dtype=torch.long, device=device)
        self._worlds = torch.arange(num_envs, device=device)
        self._lag = self._draw()

    def append(self, value: torch.Tensor, store: Store = True) -> torch.Tensor:
        """Take the newest observation and return a late one.

        Args:
            value: Newest observation, shape (N, ...).
            store: Whether to keep it, or the worlds that do; otherwise the buffer stays as it was.

        Returns:
            Observation from ``lag`` steps ago, shape (N, ...).
        """
        if store is True:
            self._age_lags(self._worlds)
        elif isinstance(store, torch.Tensor) and self._per_env:
            self._age_lags(store)
        frames = self._frames.append(value, store)
        return frames[self._worlds, self._lag_range[1] - self._lag]

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Forget the past of some worlds; those with lags of their own draw new ones, a shared one goes on."""
        self._frames.reset(env_ids)
        if self._per_env:
            fill_worlds(self._age, env_ids, 0)
            self._lag[env_ids] = self._draw()[env_ids]

    def _age_lags(self, worlds: torch.Tensor) -> None:
        """Count a control step in some worlds and give those that are due a new lag."""
        self._age[worlds] += 1
        draw = self._draw()
        is_due = (self._age % self._period == 0) & (
            self._each(self._random.uniform(f"{self._tag}: hold")) >= self._hold_prob
        )
        self._lag[worlds] = torch.where(is_due, draw, self._lag)[worlds]

    def _draw(self) -> torch.Tensor:
        return self._each(self._random.integers(self._tag, self._lag_range[0], self._lag_range[1] + 1)).clone()

    def _each(self, drawn: torch.Tensor) -> torch.Tensor:
        """Return what every world drew, or the first world's in all, shape (N,)."""
        return drawn if self._per_env else drawn[:1].expand(self._num_envs)
