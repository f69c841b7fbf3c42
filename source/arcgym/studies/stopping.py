# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Lets Ctrl-C and SIGTERM end a study with the checkpoints of its running cells."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_asked = threading.Event()


def was_stopped() -> bool:
    """Return whether the study was asked to stop."""
    return _asked.is_set()


@contextmanager
def stopping_on_signals() -> Iterator[None]:
    """Take SIGINT and SIGTERM as the wish to stop while the block runs; a second one ends the program at once."""
    _asked.clear()
    signals = (signal.SIGINT, signal.SIGTERM)
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous: dict[int, Any] = {}

    def ask(number: int, _frame: Any) -> None:
        print("stopping: cells that run write a checkpoint first", flush=True)
        _asked.set()
        for other, handler in previous.items():
            signal.signal(other, handler)

    previous |= {number: signal.signal(number, ask) for number in signals}
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
