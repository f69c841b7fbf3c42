# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two things at the same time on two cores of a CPU. Warp's kernels on a CPU run outside Python, each in one thread."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

VARIABLE = "ARCGYM_CPU_THREADS"
"""Environment variable with the number of threads; results are the same to the bit."""


@functools.cache
def _worker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "arcgym")


def cpu_threads() -> int:
    """Return how many threads physics and drawing may use on a CPU: 2 with ``ARCGYM_CPU_THREADS=2``, else 1.

    Raises:
        ValueError: If that variable is something else.
    """
    value = os.environ.get(VARIABLE, "1")
    if value not in ("1", "2"):
        raise ValueError(f"{VARIABLE}={value!r}: expected 1 or 2.")
    return int(value)


def both(one: Callable[[], None], other: Callable[[], None]) -> None:
    """Do ``one`` in this thread and ``other`` in a second one, and wait for both; neither may need the other."""
    done = _worker().submit(other)
    try:
        one()
    finally:
        done.result()
