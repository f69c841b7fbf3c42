# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The name of a device, and memory in use. Importing this loads neither torch nor Warp."""

from __future__ import annotations

import resource
import sys
from pathlib import Path


def full_name(device: str) -> str:
    """Return the device with the hardware's name, e.g. ``cuda:0 (NVIDIA H100)``."""
    import warp as wp

    return f"{device} ({wp.get_device(device).name})"


def device_mib(device: str) -> float | None:
    """Return the memory in use on a GPU, by whatever program [MiB]; None on the CPU."""
    import warp as wp

    if not device.startswith("cuda"):
        return None
    wp.synchronize_device(device)
    found = wp.get_device(device)
    return (found.total_memory - found.free_memory) / 2**20


def peak_host_mib() -> float:
    """Return the largest resident memory of this process so far [MiB]."""
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def host_mib() -> float:
    """Return the resident memory of this process [MiB]; where the system does not tell, the largest so far."""
    statm = Path("/proc/self/statm")
    if not statm.is_file():
        return peak_host_mib()
    return int(statm.read_text().split()[1]) * resource.getpagesize() / 2**20
