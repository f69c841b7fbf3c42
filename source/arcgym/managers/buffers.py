# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rings of past observations, one a world."""

from __future__ import annotations

import torch

from arcgym.utils.worlds import fill_worlds


class FrameBuffer:
    """Keeps the last frames of every world; the first frame after a reset fills them all.

    Every result is new memory, so what was handed out never changes.
    """

    def __init__(self, length: int, num_envs: int, device: str) -> None:
        """Makes an empty buffer.

        Args:
            length: Number of frames L.
            num_envs: Number of worlds N.
            device: Device of the frames.
        """
        self._length = length
        self._frames: torch.Tensor | None = None
        self._is_empty = torch.ones(num_envs, dtype=torch.bool, device=device)

    def append(self, value: torch.Tensor, store: bool = True) -> torch.Tensor:
        """Returns the frames with ``value`` as the newest, oldest first.

        Args:
            value: Newest frame, shape (N, ...).
            store: Whether to keep it; otherwise the buffer stays as it was.

        Returns:
            Frames, shape (N, L, ...).
        """
        newest = value.unsqueeze(1)
        filled = newest.expand(-1, self._length, *value.shape[1:])
        if self._frames is None:
            frames = filled.clone()
        else:
            shifted = torch.cat((self._frames[:, 1:], newest), dim=1)
            frames = torch.where(self._is_empty.view(-1, *[1] * value.dim()), filled, shifted)
        if store:
            self._frames = frames
            self._is_empty.zero_()
        return frames

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Empties the buffers of some worlds."""
        fill_worlds(self._is_empty, env_ids, True)


class DelayBuffer:
    """Hands out observations some control steps late."""

    def __init__(
        self,
        lag_range: tuple[int, int],
        num_envs: int,
        device: str,
        *,
        per_env: bool = True,
        hold_prob: float = 0.0,
        update_period: int = 0,
    ) -> None:
        """Draws the first lags.

        Args:
            lag_range: Smallest and largest lag [control steps].
            num_envs: Number of worlds N.
            device: Device of the observations.
            per_env: Whether each world draws its own lag.
            hold_prob: Probability of keeping the lag when a new one is due.
            update_period: Control steps between new lags; zero draws one each step.
        """
        if not 0 <= lag_range[0] <= lag_range[1]:
            raise ValueError(f"Delay lags must satisfy 0 <= min <= max, got {lag_range}.")
        self._lag_range = lag_range
        self._num_envs = num_envs
        self._device = device
        self._per_env = per_env
        self._hold_prob = hold_prob
        self._period = max(update_period, 1)
        self._frames = FrameBuffer(lag_range[1] + 1, num_envs, device)
        self._age = torch.zeros(num_envs, dtype=torch.long, device=device)
        self._worlds = torch.arange(num_envs, device=device)
        self._lag = self._draw()

    def append(self, value: torch.Tensor, store: bool = True) -> torch.Tensor:
        """Takes the newest observation and returns a late one.

        Args:
            value: Newest observation, shape (N, ...).
            store: Whether to keep it; otherwise the buffer stays as it was.

        Returns:
            Observation from ``lag`` steps ago, shape (N, ...).
        """
        if store:
            self._age += 1
            draw = self._draw()
            is_due = (self._age % self._period == 0) & (self._uniform() >= self._hold_prob)
            self._lag.copy_(torch.where(is_due, draw, self._lag))
        frames = self._frames.append(value, store)
        return frames[self._worlds, self._lag_range[1] - self._lag]

    def reset(self, env_ids: torch.Tensor | slice) -> None:
        """Forgets the past of some worlds; those with lags of their own draw new ones."""
        self._frames.reset(env_ids)
        fill_worlds(self._age, env_ids, 0)
        if self._per_env:
            self._lag[env_ids] = self._draw()[env_ids]

    def _draw(self) -> torch.Tensor:
        size = self._num_envs if self._per_env else 1
        lag = torch.randint(self._lag_range[0], self._lag_range[1] + 1, (size,), device=self._device)
        return lag.expand(self._num_envs).clone()

    def _uniform(self) -> torch.Tensor:
        return torch.rand(self._num_envs if self._per_env else 1, device=self._device)
