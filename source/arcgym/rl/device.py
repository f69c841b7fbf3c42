# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Device and seed of a run."""

from __future__ import annotations

import os
from typing import Any

import torch


def place(env_cfg: Any, agent_cfg: Any, device: str | None, distributed: bool = False) -> str:
    """Choose the device, write it and the seed into ``env_cfg``, seed torch, and return the device.

    With ``distributed`` each process of ``torchrun`` takes the GPU of its local rank and its own seed.
    """
    if distributed:
        device = f"cuda:{os.environ.get('LOCAL_RANK', '0')}"
        agent_cfg.seed += int(os.environ.get("RANK", "0"))
    device = device or ("cuda:0" if torch.cuda.is_available() else "cpu")
    device = "cuda:0" if device == "cuda" else device
    env_cfg.sim.device = device
    env_cfg.seed = agent_cfg.seed
    torch.manual_seed(agent_cfg.seed)
    return device
