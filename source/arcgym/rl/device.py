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
        found = " or ".join(["cpu", *(f"cuda:{index}" for index in range(count))])
        raise UsageError(f"--device is '{device}', which torch does not find on this machine; expected {found}.")
    return f"cuda:{number}"


def check_launcher(distributed: bool, device: str | None = None) -> None:
    """Raise unless ``--distributed`` and the way this process was started agree, and its GPU exists.

    Args:
        distributed: Whether ``--distributed`` was given.
        device: Device asked for; ``cpu`` needs no GPU.

    Raises:
        UsageError: ``torchrun`` and the flag were not used together, or there are too few GPUs.
    """
    if not distributed:
        if int(os.environ.get("WORLD_SIZE", "1")) > 1:
            raise UsageError(f"torchrun started {os.environ['WORLD_SIZE']} processes; add --distributed.")
        return
    if "RANK" not in os.environ or "WORLD_SIZE" not in os.environ:
        raise UsageError("--distributed needs torchrun --nproc_per_node=<GPUs> -m arcgym train --distributed …")
    choose_device(_rank_device(device))


def is_main_process() -> bool:
    """Return whether this process writes files: it is rank 0 of ``torchrun``, or the only one."""
    return os.environ.get("RANK", "0") == "0"


def place(env_cfg: Any, agent_cfg: Any, device: str | None, distributed: bool = False) -> str:
    """Choose the device, write it and the seed into ``env_cfg``, seed torch, and return the device.

    With ``distributed`` each process of ``torchrun`` takes the GPU of its local rank, or the CPU, and its own seed.
    """
    if distributed:
        device = _rank_device(device)
        agent_cfg.seed += int(os.environ.get("RANK", "0"))
    device = choose_device(device)
    env_cfg.sim.device = device
    env_cfg.seed = agent_cfg.seed
    torch.manual_seed(agent_cfg.seed)
    return device


def join_processes() -> dict[str, int]:
    """Join the processes of ``torchrun`` on the CPU, through gloo, and return rsl_rl's description of this one."""
    names = {"global_rank": "RANK", "local_rank": "LOCAL_RANK", "world_size": "WORLD_SIZE"}
    about = {name: int(os.environ[variable]) for name, variable in names.items()}
    if not torch.distributed.is_initialized():
        torch.distributed.init_process_group("gloo", rank=about["global_rank"], world_size=about["world_size"])
    return about


def leave_processes() -> None:
    """Leave the group of processes, if there is one: what follows is done by each process alone."""
    if torch.distributed.is_available() and torch.distributed.is_initialized():
        torch.distributed.destroy_process_group()


def _rank_device(device: str | None) -> str:
    """Return the device of a process of ``torchrun``: the GPU of its local rank, or the CPU where that is asked for."""
    return "cpu" if device == "cpu" else f"cuda:{os.environ.get('LOCAL_RANK', '0')}"
