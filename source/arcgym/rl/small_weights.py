# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Weights in a quarter of their size: matrices as whole numbers with a scale for each output, the rest in half."""

from __future__ import annotations

from typing import Any

import torch

LEVELS = 127
"""Largest whole number of a weight."""

SMALLEST = 4096
"""Numbers from which on a matrix is worth it."""

SCALES = "actor_scales"
"""Key of a checkpoint that holds the scales of its actor's matrices by name, each of shape (outputs,)."""


def shrink(actor: dict[str, Any], levels: int = LEVELS) -> tuple[dict[str, Any], dict[str, torch.Tensor]]:
    """Return weights in a quarter to a half of their size, and the scales of those that are whole numbers.

    A row of a matrix is rounded to the multiples of its scale that reach its largest weight, 255 by default: each
    weight is then off by at most 1/254 of that.

    Args:
        actor: Weights by name; the outputs of matrices and kernels come first in their shapes.
        levels: Largest whole number of a weight, up to 127. Smaller ones are rounder and compress better.

    Raises:
        ValueError: If ``levels`` is out of its bounds.
    """
    if not 1 <= levels <= LEVELS:
        raise ValueError(f"levels is {levels}, expected 1 to {LEVELS}.")
    small, scales = {}, {}
    for name, value in actor.items():
        if not torch.is_tensor(value) or not value.is_floating_point():
            small[name] = value
        elif value.ndim < 2 or value.numel() < SMALLEST:
            small[name] = value.half()
        else:
            rows = value.float().flatten(1)
            scales[name] = (rows.abs().amax(1) / levels).clamp_min(torch.finfo(torch.float32).tiny)
            small[name] = torch.round(rows / scales[name][:, None]).to(torch.int8).view(value.shape)
    return small, scales


def restore(contents: dict[str, Any]) -> dict[str, Any]:
    """Return the contents of a checkpoint with the weights of a shrunk actor in full; others are returned as they are.

    Args:
        contents: A checkpoint with ``actor_state_dict``, and :data:`SCALES` if it was shrunk.
    """
    scales = contents.get(SCALES)
    if not scales:
        return contents
    actor = dict(contents["actor_state_dict"])
    for name, scale in scales.items():
        shape = (-1,) + (1,) * (actor[name].ndim - 1)
        actor[name] = actor[name].float() * scale.view(shape)
    return {**{name: value for name, value in contents.items() if name != SCALES}, "actor_state_dict": actor}
