# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Several things at the same time on the cores of a CPU.

Warp's kernels on a CPU run outside Python, each in one thread. Physics and drawing share theirs out over several, with
the same results to the bit.
"""

from __future__ import annotations

import functools
import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

VARIABLE = "ARCGYM_CPU_THREADS"
"""Environment variable with the number of threads; see :class:`Pace` for what is done without it."""
DEFAULT = 2
"""Threads without it, where there are so many cores: more were not measured."""
MOST = 64
"""Threads at most."""
FIRST_TRIALS = 4
"""Runs of a :class:`Pace` that are made in turns with one and several threads before the faster is chosen."""
BETWEEN_TRIALS = 64
"""Runs after which what was slower is tried again."""

Part = TypeVar("Part")


def cpu_threads() -> int:
    """Return how many threads physics and drawing may use on a CPU.

    Raises:
        ValueError: If the environment variable is no such number.
    """
    value = os.environ.get(VARIABLE)
    if value is None:
        return min(DEFAULT, _cores())
    if not value.isdecimal() or not 1 <= int(value) <= MOST:
        raise ValueError(f"{VARIABLE}={value!r}: expected a number of threads from 1 to {MOST}.")
    return int(value)


class Pace:
    """How many threads to use for some work that is done again and again.

    As many as the environment variable says. Without it one or :func:`cpu_threads`, what took less time in the last
    runs: where other programs keep the cores busy, threads that wait for each other are slower than one.
    """

    def __init__(self) -> None:
        """Nothing is known yet."""
        self._took: dict[int, float] = {}
        self._runs = 0

    def run(self, work: Callable[[int], None], amount: int = 1) -> None:
        """Do ``work``, which takes the number of threads; durations are compared by ``amount`` of work."""
        threads = self.threads()
        began = time.perf_counter()
        work(threads)
        self.note(threads, (time.perf_counter() - began) / amount)

    def threads(self) -> int:
        """Return how many threads to use in the next run."""
        most = cpu_threads()
        if most == 1 or VARIABLE in os.environ:
            return most
        if self._runs < FIRST_TRIALS:
            return 1 if self._runs % 2 else most
        fast, slow = sorted((1, most), key=lambda threads: self._took.get(threads, 0.0))
        return slow if self._runs % BETWEEN_TRIALS == 0 else fast

    def note(self, threads: int, took: float) -> None:
        """Remember how long a run took [s]."""
        before = self._took.get(threads, took) if self._runs >= FIRST_TRIALS else took
        self._took[threads] = 0.5 * (before + took)
        self._runs += 1


def on_threads(threads: int, work: Callable[[int], None]) -> None:
    """Do ``work``, which takes the number of its thread, in this one (0) and others at once; wait for all that began.

    Others that did not begin before this one was done are called off: ``work`` has to be whole without them.
    """
    others: list[Future[None]] = [_workers().submit(work, k) for k in range(1, threads)]
    try:
        work(0)
    finally:
        for other in others:
            if not other.cancel():
                other.result()


def share_out(threads: int, parts: Sequence[Part], work: Callable[[Part], None]) -> None:
    """Do ``work`` on all parts, whichever thread is free on the next."""
    left = list(reversed(parts))

    def take(thread: int) -> None:
        while left:
            try:
                part = left.pop()
            except IndexError:  # another thread took the last one meanwhile
                return
            work(part)

    on_threads(threads, take)


@functools.cache
def _workers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(MOST, "arcgym")


def _cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
