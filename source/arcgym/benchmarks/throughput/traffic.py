# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How near the physics comes to the limit that the device's memory sets."""

from __future__ import annotations

from typing import Any

import torch
import warp as wp

from arcgym.benchmarks.timing import median_ms

COPIED_MIB = {"cuda": 1024, "cpu": 128}
"""Size of the array that is copied to measure the bandwidth, by kind of device [MiB]; far beyond the caches."""
NOT_STEPPED = {"_library", "snapshots"}
"""Attributes of a simulation with arrays that no step touches."""
WALKED = ("arcgym.", "newton.", "mujoco_warp.")
"""Beginnings of the names of modules whose objects are searched for arrays."""


def traffic(sim: Any, decimation: int, physics_ms: float) -> dict[str, float]:
    """Estimate the memory traffic of the physics, beside the device's limit.

    A physics step is taken to read and to write every array of the simulation once. It may read some several times and
    others not at all, so that the share tells the order of magnitude.

    Args:
        sim: The simulation.
        decimation: Physics steps in a control step.
        physics_ms: Duration of these [ms].
    """
    arrays, limit = sum(device_arrays(sim).values()), copy_bandwidth(str(sim.device))
    used = 2.0 * arrays * decimation / (1.0e-3 * physics_ms)
    return {
        "array_mib": arrays / 2**20,
        "estimated_gb_per_s": 1.0e-9 * used,
        "copy_gb_per_s": 1.0e-9 * limit,
        "share": used / limit,
    }


def copy_bandwidth(device: str) -> float:
    """Return the bytes that a device reads and writes in a second while it copies a large array."""
    size = COPIED_MIB["cuda" if device.startswith("cuda") else "cpu"] * 2**20
    source = torch.zeros(size, dtype=torch.uint8, device=device)
    target = torch.empty_like(source)
    duration = median_ms(lambda: target.copy_(source), device, repeats=9)
    return 2.0 * size / (1.0e-3 * duration)


def device_arrays(root: Any) -> dict[int, int]:
    """Return the bytes of every array that an object holds, itself or through others, by address; views count once."""
    found: dict[int, int] = {}
    seen: set[int] = set()
    waiting = [root]
    while waiting:
        item = waiting.pop()
        if id(item) in seen:
            continue
        seen.add(id(item))
        if isinstance(item, wp.array):
            if item.ptr:
                found[item.ptr] = max(found.get(item.ptr, 0), int(item.capacity))
        elif isinstance(item, torch.Tensor):
            storage = item.untyped_storage()
            found[storage.data_ptr()] = max(found.get(storage.data_ptr(), 0), storage.nbytes())
        else:
            waiting += members(item)
    return found


def members(item: Any) -> list[Any]:
    """Return the items of a container, or the attributes of an object of the physics."""
    if isinstance(item, dict):
        return list(item.values())
    if isinstance(item, list | tuple):
        return list(item)
    fields = getattr(getattr(item, "_cls", None), "vars", None)  # a warp struct
    if isinstance(fields, dict):
        return [getattr(item, name) for name in fields]
    if type(item).__module__.startswith(WALKED):
        return [value for name, value in getattr(item, "__dict__", {}).items() if name not in NOT_STEPPED]
    return []
