# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Progress of long work, shown on a terminal as one moving line, elsewhere as plain lines.

Code that works long calls :func:`report` with the name of the stage it begins; where nobody shows progress, that costs
nothing. Commands wrap the work in :func:`shown`. Importing this loads neither torch nor Warp.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

LINE_PERIOD_S = 10.0
"""Longest time between two lines of counted steps where there is no terminal, but for a step that takes longer [s]."""

_listeners: list[Callable[[str], None]] = []
_moving_lines: list[Any] = []


def report(stage: str) -> None:
    """Say which stage of the work begins, such as ``building 64 worlds``."""
    for listener in _listeners:
        listener(stage)


@contextmanager
def listening(listener: Callable[[str], None]) -> Iterator[None]:
    """Let ``listener`` hear every stage that is reported within the block."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


@contextmanager
def shown(title: str) -> Iterator[None]:
    """Show the stages reported within the block, and at its end how long it took.

    Args:
        title: Name of the whole, such as ``environment``.
    """
    start = time.perf_counter()
    if sys.stdout.isatty():
        from rich.console import Console

        with Console().status(f"{title} …") as status, listening(lambda stage: status.update(f"{title}: {stage} …")):
            _moving_lines.append(status)
            try:
                yield
            finally:
                _moving_lines.remove(status)
    else:
        with listening(lambda stage: print(f"{title}: {stage}", flush=True)):
            yield
    print(f"{title}: ready after {time.perf_counter() - start:.1f} s", flush=True)


@contextmanager
def paused() -> Iterator[None]:
    """Take the line of :func:`shown` away while the block shows a line of its own."""
    hidden = list(_moving_lines)
    for line in hidden:
        line.stop()
    try:
        yield
    finally:
        for line in hidden:
            line.start()


@contextmanager
def counted(title: str, total: int) -> Iterator[Callable[[int], None]]:
    """Show how many of ``total`` steps are done: a bar on a terminal, elsewhere a line every tenth or ten seconds.

    Yields:
        Function to call with the number of steps done.
    """
    if sys.stdout.isatty():
        from rich.progress import Progress

        with Progress(transient=True) as bar:
            task = bar.add_task(title, total=total)
            yield lambda done: bar.update(task, completed=done)
    else:
        yield _printer(title, total)


def _printer(title: str, total: int) -> Callable[[int], None]:
    """Return a function that prints a line when another tenth of the steps is done, or the last line is old."""
    tenths, printed = 0, time.perf_counter()

    def show(done: int) -> None:
        nonlocal tenths, printed
        reached = 10 * done // max(total, 1)
        if reached > tenths or time.perf_counter() - printed > LINE_PERIOD_S:
            tenths, printed = reached, time.perf_counter()
            print(f"{title}: {done} of {total}", flush=True)

    return show
