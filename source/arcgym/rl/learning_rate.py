# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning rate that falls over a run."""

from __future__ import annotations

from typing import Any

import torch


def linear_rate(start: float, end: float, iteration: int, num_iterations: int) -> float:
    """Return the learning rate of an iteration on the line from ``start`` to ``end``; after the last it stays there.

    Args:
        start: Rate of iteration 0.
        end: Rate of iteration ``num_iterations - 1`` and later.
        iteration: Iterations completed before this one.
        num_iterations: Iterations of the whole run.
    """
    fraction = min(iteration / max(num_iterations - 1, 1), 1.0)
    return start + (end - start) * fraction


def set_learning_rate(algorithm: Any, rate: float) -> None:
    """Give every optimizer of an algorithm the same learning rate, and the log the value."""
    for optimizer in vars(algorithm).values():
        if isinstance(optimizer, torch.optim.Optimizer):
            for group in optimizer.param_groups:
                group["lr"] = rate
    algorithm.learning_rate = rate
