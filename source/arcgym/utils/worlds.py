# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tensors with one entry a world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch


def fill_worlds(
    tensor: torch.Tensor, env_ids: torch.Tensor | Sequence[int] | slice | None, value: float, dim: int = 0
) -> None:
    """Set the entries of some worlds in place, in one operation where ``tensor[env_ids] = value`` makes two.

    Args:
        tensor: Values, worlds along ``dim``.
        env_ids: World indices, shape (n,), int64 for the one operation; None for all.
        value: What they become.
        dim: Dimension of the worlds.
    """
    if env_ids is None:
        tensor.fill_(value)
    elif isinstance(env_ids, torch.Tensor) and env_ids.dtype == torch.long:
        tensor.index_fill_(dim, env_ids, value)
    else:
        tensor[(slice(None),) * dim + (env_ids,)] = value


def replace_worlds(old: dict[str, Any], new: dict[str, Any], env_ids: torch.Tensor) -> dict[str, Any]:
    """Return a copy of named tensors, also of nested ones, in which some worlds have the values of others.

    Args:
        old: Values of the worlds that stay, each of shape (N, ...).
        new: Values of the others, with the same names and shapes.
        env_ids: World indices, int64, shape (n,).
    """
    return {
        name: replace_worlds(value, new[name], env_ids)
        if isinstance(value, dict)
        else value.index_copy(0, env_ids, new[name][env_ids])
        for name, value in old.items()
    }


def finite(values: torch.Tensor) -> torch.Tensor:
    """Return a copy in which what is not finite is zero."""
    return torch.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
