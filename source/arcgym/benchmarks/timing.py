# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Durations of calls on a device."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

Action = Callable[[], object]
"""Something to be timed."""


def time_ms(action: Action, device: str) -> float:
    """Return the duration of one call [ms]; the device is idle before it and has finished after it."""
    wp.synchronize_device(device)
    start = time.perf_counter()
    action()
    wp.synchronize_device(device)
    return 1.0e3 * (time.perf_counter() - start)


def median_ms(action: Action, device: str, repeats: int, prepare: Action | None = None) -> float:
    """Return the median duration of a call [ms], after one call that is not counted.

    Args:
        action: What is timed.
        device: Warp device that it runs on.
        repeats: Timed calls.
        prepare: Called before every call, untimed.
    """
    durations = []
    for _ in range(repeats + 1):
        if prepare is not None:
            prepare()
        durations.append(time_ms(action, device))
    return statistics.median(durations[1:])
