# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Weights of a policy for one that sees further images."""

from __future__ import annotations

import torch


def widened(weights: dict[str, torch.Tensor], wanted: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return weights of a policy with kernels for further channels, which are nought: its actions stay the same.

    Terms that a run adds to the images come behind those that are there, so that the first channels keep their meaning.

    Args:
        weights: Weights by name, as a checkpoint has them.
        wanted: Weights of the policy that is to take them over, for their shapes. Those that differ in more than the
            channels of their input, or have fewer, are left as they are.
    """
    return {name: _filled(value, wanted[name]) if name in wanted else value for name, value in weights.items()}


def _filled(value: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    """Return a kernel of shape (outputs, channels, H, W) with channels of zeros behind its own."""
    if value.ndim != 4 or value.shape == wanted.shape:
        return value
    outputs, channels, *kernel = value.shape
    if wanted.ndim != 4 or wanted.shape[1] < channels or (wanted.shape[0], *wanted.shape[2:]) != (outputs, *kernel):
        return value
    return torch.cat([value, value.new_zeros(outputs, wanted.shape[1] - channels, *kernel)], dim=1)
