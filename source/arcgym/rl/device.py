# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Device, seed and process of a run."""

from __future__ import annotations

import os
import re
from typing import Any

import torch

from arcgym.utils.errors import UsageError


def choose_device(device: str | None) -> str:
    """Return the device in full, ``cpu`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none.

    Raises:
        UsageError: The name is no device, or this machine does not have it.
    """
    count = torch.cuda.device_count() if torch.cuda.is_available() else 0
    if device is None:
        return "cuda:0" if count else "cpu"
    match = re.fullmatch(r"cpu|cuda(?::(\d+))?", device)
    if match is None:
        raise UsageError(f"--device is '{device}', expected cpu, cuda or cuda:<n>.")
    if device == "cpu":
        return device
    number = int(match[1] or 0)
    if number >= count:
        found = ", ".join(["cpu", *(f"cuda:{index}" for index in range(count))])
        raise UsageError(f"--device is '{device}', which torch does not find on this machine; expected one of {found}.")
    return f"cuda:{number}"


def check_launcher(distributed: bool) -> None:
    """Raise unless ``--distributed`` and the way this process was started agree, and its GPU exists.

    Raises:
        UsageError: ``torchrun`` and the flag were not used together, or there are too few GPUs.
    """
    if not distributed:
        if int(os.environ.get("WORLD_SIZE", "1")) > 1:
            raise UsageError(f"torchrun started {os.environ['WORLD_SIZE']} processes; add --distributed.")
        return
    if "RANK" not in os.environ or "WORLD_SIZE" not in os.environ:
        raise UsageError("--distributed needs torchrun --nproc_per_node=<GPUs> -m arcgym train --distributed …")
    choose_device(f"cuda:{os.environ.get('LOCAL_RANK', '0')}")


def is_main_process() -> bool:
    """Return whether this process writes files: it is rank 0 of ``torchrun``, or the only one."""
    return os.environ.get("RANK", "0") == "0"


def place(env_cfg: Any, agent_cfg: Any, device: str | None, distributed: bool = False) -> str:
    """Choose the device, write it and the seed into ``env_cfg``, seed torch, and return the device.

    With ``distributed`` each process of ``torchrun`` takes the GPU of its local rank and its own seed.
    """
    if distributed:
        device = f"cuda:{os.environ.get('LOCAL_RANK', '0')}"
        agent_cfg.seed += int(os.environ.get("RANK", "0"))
    device = choose_device(device)
    env_cfg.sim.device = device
    env_cfg.seed = agent_cfg.seed
    torch.manual_seed(agent_cfg.seed)
    return device
