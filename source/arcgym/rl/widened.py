# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Weights of a policy for one that sees further images, reads vectors beside them, or has a memory."""

from __future__ import annotations

import torch

FIRST_MATRIX = "mlp.0.weight"
"""Matrix that reads the features, shape (outputs, features)."""

RECURRENT = "rnn."
"""Beginning of the names of a recurrent layer's weights."""

NORMALIZER = "obs_normalizer."
"""Beginning of the names of the means and deviations by which vectors are normalized."""


def widened(weights: dict[str, torch.Tensor], wanted: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return weights of a policy with kernels for further channels, which are nought: its actions stay the same.

    Terms that a run adds to the images come behind those that are there, so that the first channels keep their meaning.

    Args:
        weights: Weights by name, as a checkpoint has them.
        wanted: Weights of the policy that is to take them over, for their shapes. Those that differ in more than the
            channels of their input, or have fewer, are left as they are.
    """
    return {name: _filled(value, wanted[name]) if name in wanted else value for name, value in weights.items()}


def with_memory(
    weights: dict[str, torch.Tensor], wanted: dict[str, torch.Tensor], width: int
) -> dict[str, torch.Tensor]:
    """Return weights of a policy without memory for one with it, whose MLP reads the memory behind the features.

    The first matrix gets a column of zeros for each number remembered, so that actions stay the same; the recurrent
    layer, which the weights lack, stays as it is.

    Args:
        weights: Weights by name, as a checkpoint has them. Those that hold a recurrent layer, or whose first matrix
            differs in more than these columns, are left as they are.
        wanted: Weights of the policy that is to take them over.
        width: Numbers that the recurrent layer gives to the MLP.
    """
    if any(name.startswith(RECURRENT) for name in weights) or FIRST_MATRIX not in weights:
        return weights
    matrix = weights[FIRST_MATRIX]
    if wanted[FIRST_MATRIX].shape != (len(matrix), matrix.shape[-1] + width):
        return weights
    recurrent = {name: value for name, value in wanted.items() if name.startswith(RECURRENT)}
    return {**weights, **recurrent, FIRST_MATRIX: torch.cat([matrix, matrix.new_zeros(len(matrix), width)], dim=1)}


def with_vectors(
    weights: dict[str, torch.Tensor], wanted: dict[str, torch.Tensor], width: int
) -> dict[str, torch.Tensor]:
    """Return weights of a policy of images for one that reads vectors besides, in front of the features.

    The first matrix gets a column of zeros for each of their numbers, so that actions stay the same; what normalizes
    the vectors, which the weights lack, stays as it is.

    Args:
        weights: Weights by name, as a checkpoint has them. Those whose first matrix differs in more than these columns
            are left as they are.
        wanted: Weights of the policy that is to take them over.
        width: Numbers in the vectors.
    """
    if FIRST_MATRIX not in weights or width == 0:
        return weights
    matrix = weights[FIRST_MATRIX]
    if wanted[FIRST_MATRIX].shape != (len(matrix), width + matrix.shape[-1]):
        return weights
    normalizer = {name: value for name, value in wanted.items() if name.startswith(NORMALIZER)}
    return {**weights, **normalizer, FIRST_MATRIX: torch.cat([matrix.new_zeros(len(matrix), width), matrix], dim=1)}


def _filled(value: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    """Return a kernel of shape (outputs, channels, H, W) with channels of zeros behind its own."""
    if value.ndim != 4 or value.shape == wanted.shape:
        return value
    outputs, channels, *kernel = value.shape
    if wanted.ndim != 4 or wanted.shape[1] < channels or (wanted.shape[0], *wanted.shape[2:]) != (outputs, *kernel):
        return value
    return torch.cat([value, value.new_zeros(outputs, wanted.shape[1] - channels, *kernel)], dim=1)
