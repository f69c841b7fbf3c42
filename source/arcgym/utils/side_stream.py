# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Launches beside others on a GPU."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


class SideStream:
    """A second stream of a GPU; on a CPU everything is done in order."""

    def __init__(self, device: str, priority: int = 0):
        """Make the stream; with a ``priority`` of -1, blocks launched here go before those of other streams."""
        self._device = wp.get_device(device)
        self.on_gpu = self._device.is_cuda
        self._stream = wp.Stream(self._device, priority=priority) if self.on_gpu else None

    @contextmanager
    def scope(self) -> Iterator[None]:
        """Launch what is done in here after all that was launched before, and beside what follows until :meth:`join`.

        Neither may write what the other reads or writes.
        """
        if self._stream is None:
            yield
            return
        with wp.ScopedStream(self._stream):
            yield

    def join(self) -> None:
        """Have what follows wait for it."""
        if self._stream is not None:
            wp.get_stream(self._device).wait_stream(self._stream)
