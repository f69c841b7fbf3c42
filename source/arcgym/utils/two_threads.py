# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two things at the same time on two cores of a CPU. Warp's kernels on a CPU run outside Python, each in one thread."""

from __future__ import annotations

import functools
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import torch


@functools.cache
def _worker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "arcgym")


def cpu_threads() -> int:
    """Return how many threads work on a CPU may use, 1 or 2: as torch, which keeps to ``OMP_NUM_THREADS``."""
    return min(2, torch.get_num_threads())


def both(one: Callable[[], None], other: Callable[[], None]) -> None:
    """Do ``one`` in this thread and ``other`` in a second one, and wait for both; neither may need the other."""
    done = _worker().submit(other)
    try:
        one()
    finally:
        done.result()
