# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Generalized advantage estimation for signals other than the reward."""

from __future__ import annotations

import torch


def discounted_advantages(
    signal: torch.Tensor, values: torch.Tensor, last: torch.Tensor, dones: torch.Tensor, gamma: float, lam: float
) -> torch.Tensor:
    """Return the advantages of a rollout (Schulman et al. 2016, arXiv:1506.02438).

    Args:
        signal: What each of T steps in N worlds earned or cost, shape (T, N, 1).
        values: Value of the state before each step, same shape.
        last: Value of the state after the last step, shape (N, 1).
        dones: Whether the episode ended with the step, same shape as ``signal``.
        gamma: Discount of a step.
        lam: Trace decay.
    """
    advantages, following, trace = torch.zeros_like(signal), last, torch.zeros_like(last)
    for step in reversed(range(signal.shape[0])):
        alive = 1.0 - dones[step].float()
        trace = signal[step] + alive * gamma * following - values[step] + alive * gamma * lam * trace
        advantages[step] = trace
        following = values[step]
    return advantages
