# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning rate that falls over a run."""

from __future__ import annotations

from typing import Any

import torch


def linear_rate(start: float, end: float, fraction: float) -> float:
    """Return the learning rate on the line from ``start`` to ``end``; after the end it stays there.

    Args:
        start: Rate at the beginning of the run.
        end: Rate at its end.
        fraction: Share of the run that is over, from 0 to 1.
    """
    return start + (end - start) * min(max(fraction, 0.0), 1.0)


def set_learning_rate(algorithm: Any, rate: float) -> None:
    """Give every optimizer of an algorithm the same learning rate, and the log the value.

    Rates that are tensors are written in place: a CUDA graph reads them there.
    """
    for optimizer in vars(algorithm).values():
        if isinstance(optimizer, torch.optim.Optimizer):
            for group in optimizer.param_groups:
                if isinstance(group["lr"], torch.Tensor):
                    group["lr"].fill_(rate)
                else:
                    group["lr"] = rate
    algorithm.learning_rate = rate
