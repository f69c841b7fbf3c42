# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Stops training on Ctrl-C or SIGTERM at a moment when the networks are whole."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import torch


class TrainingInterrupted(KeyboardInterrupt):
    """Training was asked to stop; the runner has saved a checkpoint by the time a script sees this."""

    def __init__(self, signal_number: int):
        """Remember which signal it was."""
        super().__init__(signal.Signals(signal_number).name)
        self.signal_number = signal_number


class InterruptGuard:
    """Turns SIGINT and SIGTERM into :class:`TrainingInterrupted`, held back inside :meth:`hold`.

    A second signal is not held back, so that a stuck process can still be stopped.

    Processes that learn together stop together, after the update before which any of them had a signal: one that left
    at once would leave the others waiting for its gradients, without a checkpoint. All their signals are held back;
    ``torchrun`` kills what does not end within 30 s.
    """

    SIGNALS = (signal.SIGINT, signal.SIGTERM)

    def __init__(self, together: bool = False) -> None:
        """Create the guard; it acts inside its ``with`` block, and only in the main thread.

        Args:
            together: Whether other processes of ``torchrun`` learn along.
        """
        self._together = together
        self._held = False
        self._pending: int | None = None
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> InterruptGuard:
        """Install the handlers."""
        if threading.current_thread() is threading.main_thread():
            self._previous = {number: signal.signal(number, self._handle) for number in self.SIGNALS}
        return self

    def __exit__(self, *_: object) -> None:
        """Restore the handlers that were there before."""
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Let the block finish before a signal takes effect."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        number = self._agreed()
        if number is not None:
            raise TrainingInterrupted(number)

    def _handle(self, number: int, _frame: FrameType | None) -> None:
        if not self._together and (not self._held or self._pending is not None):
            raise TrainingInterrupted(number)
        self._pending = number

    def _agreed(self) -> int | None:
        """Return the signal that this process, or one that learns along, was sent; None if there was none."""
        if not self._together:
            return self._pending
        number = torch.tensor(self._pending or 0)
        if torch.distributed.get_backend() == "nccl":
            number = number.cuda()
        torch.distributed.all_reduce(number, op=torch.distributed.ReduceOp.MAX)
        return int(number) or None
