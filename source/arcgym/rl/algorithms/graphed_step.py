# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Gradient steps as CUDA graphs: one launch in place of hundreds, which otherwise take longer than the work itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import torch

from arcgym.rl.replay import ReplayBatch

Losses = dict[str, torch.Tensor]
"""Losses of a step by name, scalars."""

WARM_UP = 11
"""Steps made one launch at a time before a graph is captured, as PyTorch advises for networks with their optimizers."""


class GraphedStep:
    """Calls a step on batches of always the same shapes; replays it as a graph after a few calls.

    The step may not wait for the device, and what it allocates it may not hand on but as losses.
    """

    def __init__(self, step: Callable[[ReplayBatch], Losses]) -> None:
        """Keep the step.

        Args:
            step: Makes one gradient step and returns its losses.
        """
        self._step = step
        self._calls = 0
        self._stream = torch.cuda.Stream()
        self._graph: torch.cuda.CUDAGraph | None = None
        self._batch: ReplayBatch | None = None
        self._losses: Losses = {}

    def __call__(self, batch: ReplayBatch) -> Losses:
        """Make the step. The losses are overwritten by the next call."""
        self._calls += 1
        if self._calls <= WARM_UP:
            return self._warm_up(batch)
        if self._graph is None:
            self._capture(batch)
        assert self._graph is not None and self._batch is not None
        _copy(batch, self._batch)
        self._graph.replay()
        return self._losses

    def _warm_up(self, batch: ReplayBatch) -> Losses:
        """Make the step on the stream that the graph will be captured on."""
        self._stream.wait_stream(torch.cuda.current_stream())
        with torch.cuda.stream(self._stream):
            losses = self._step(batch)
        torch.cuda.current_stream().wait_stream(self._stream)
        return losses

    def _capture(self, batch: ReplayBatch) -> None:
        """Record the step; nothing is computed."""
        self._batch = ReplayBatch(**{field.name: getattr(batch, field.name).clone() for field in fields(batch)})
        self._graph = torch.cuda.CUDAGraph()
        with torch.cuda.graph(self._graph, stream=self._stream):
            self._losses = self._step(self._batch)


def _copy(source: ReplayBatch, target: ReplayBatch) -> None:
    """Write a batch into the memory that the graph reads."""
    for field in fields(source):
        new, old = getattr(source, field.name), getattr(target, field.name)
        if isinstance(new, torch.Tensor):
            old.copy_(new)
        else:
            for name in new.keys():  # noqa: SIM118 - a TensorDict iterates over its batch
                old[name].copy_(new[name])
