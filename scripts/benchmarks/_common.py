# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Timing, memory and steps that the benchmarks share. Importing this loads neither torch nor Warp."""

from __future__ import annotations

import argparse
import resource
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

Action = Callable[[], object]
"""Something to be timed."""


def time_ms(action: Action, device: str) -> float:
    """Duration of one call [ms]; the device is idle before it and has finished after it."""
    import warp as wp

    wp.synchronize_device(device)
    start = time.perf_counter()
    action()
    wp.synchronize_device(device)
    return 1.0e3 * (time.perf_counter() - start)


def median_ms(action: Action, device: str, repeats: int, prepare: Action | None = None) -> float:
    """Median duration of a call [ms], after one call that is not counted.

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


def best_device() -> str:
    """First GPU, or the CPU where there is none."""
    import torch

    return "cuda:0" if torch.cuda.is_available() else "cpu"


def full_name(device: str) -> str:
    """Device with the hardware's name, e.g. ``cuda:0 (NVIDIA H100)``."""
    import warp as wp

    return f"{device} ({wp.get_device(device).name})"


def device_mib(device: str) -> float | None:
    """Memory in use on a GPU, by whatever program [MiB]; None on the CPU."""
    import warp as wp

    if not device.startswith("cuda"):
        return None
    wp.synchronize_device(device)
    found = wp.get_device(device)
    return (found.total_memory - found.free_memory) / 2**20


def peak_host_mib() -> float:
    """Largest resident memory of this process so far [MiB]."""
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def host_mib() -> float:
    """Resident memory of this process [MiB]; where the system does not tell, the largest so far."""
    statm = Path("/proc/self/statm")
    if not statm.is_file():
        return peak_host_mib()
    return int(statm.read_text().split()[1]) * resource.getpagesize() / 2**20


def positive(text: str) -> int:
    """Read a whole number of at least 1 from the command line."""
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number of at least 1")
    return number


def counts(text: str) -> list[int]:
    """Read numbers of at least 1 that commas separate."""
    return [positive(part) for part in text.split(",")]


def forward_axis(env: Any) -> int:
    """Raw action of a navigation task that drives the tip, or a pushed scope's base, forwards."""
    manager = env.action_manager
    names = [name for term in manager.active_terms for name in manager.get_term(term).axis_names]
    return next(axis for axis, name in enumerate(names) if name in ("insertion", "forward"))


def advance(env: Any, actions: Any) -> None:
    """Make the physics of a control step alone, without rewards and resets.

    Args:
        env: A manager-based environment.
        actions: Raw actions, shape (N, A).
    """
    env.action_manager.process_action(actions)
    env.action_manager.apply_action()
    env.sim.step(env.cfg.decimation)
