# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Commands that are stopped from outside: what they had begun is removed, and one line says so."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


def _ignored(number: int, frame: FrameType | None) -> None:
    """Do nothing."""


@contextmanager
def stopped_cleanly(left: str) -> Iterator[None]:
    """Let SIGINT, SIGTERM and SIGHUP unwind what runs inside, so that temporary folders are removed.

    The process then exits with 128 plus the signal's number, as shells expect. A second signal does not disturb the
    cleaning up.

    Args:
        left: What the line on stderr says about what is left, such as ``colon_7 was not made``.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        for each in _SIGNALS:
            signal.signal(each, _ignored)  # with SIG_IGN, Python complains of one that has come already
        print(f"stopped by {signal.Signals(number).name}: {left}", file=sys.stderr)
        raise SystemExit(128 + number)

    before: list[tuple[Any, Any]] = [(each, signal.signal(each, stop)) for each in _SIGNALS]
    try:
        yield
    finally:
        for each, handler in before:
            signal.signal(each, handler)
