# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Normal distribution whose mean hardly leaves [-1, 1], so that its noise reaches what the environment carries out."""

from __future__ import annotations

import torch
from rsl_rl.modules.distribution import GaussianDistribution
from torch import nn

LEAK = 0.1
"""Slope of the mean beyond the bounds: a network's output of 3 becomes 1.2. With 0 no gradient would lead back."""


class LeakyGaussianDistribution(GaussianDistribution):
    """Normal distribution with the mean ``clamp(x, -1, 1) + LEAK * (x - clamp(x, -1, 1))`` for an output ``x``.

    Action terms cut raw actions at -1 and 1. A normal distribution's mean drifts beyond them where an end of the range
    is best, and then its samples are all cut to the same action: at a mean of 3 and a deviation of 0.5 nothing else is
    ever tried. Here the mean action is carried out as before, and a third of the samples lies within the bounds.
    Weights of a policy with rsl_rl's ``GaussianDistribution`` fit.
    """

    def update(self, mlp_output: torch.Tensor) -> None:
        """Set the distribution of the network's output, shape (N, A)."""
        super().update(leaky_clamp(mlp_output))

    def deterministic_output(self, mlp_output: torch.Tensor) -> torch.Tensor:
        """Return the mean action, shape (N, A)."""
        return leaky_clamp(mlp_output)

    def as_deterministic_output_module(self) -> nn.Module:
        """Return the module that makes an exported policy's output its mean action."""
        return LeakyClamp()


class LeakyClamp(nn.Module):
    """:func:`leaky_clamp` as a module, for exported policies."""

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Return ``x`` bounded, same shape."""
        return leaky_clamp(x)


def leaky_clamp(x: torch.Tensor, leak: float = LEAK) -> torch.Tensor:
    """Return ``x`` where it is within [-1, 1], and with the slope ``leak`` beyond; same shape."""
    inside = x.clamp(-1.0, 1.0)
    return inside + leak * (x - inside)
