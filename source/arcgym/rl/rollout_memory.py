# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Memory that a rollout will take, known before it is allocated."""

from __future__ import annotations

from typing import cast

import torch
from tensordict import TensorDict

_SCALARS = 6
"""float32 values that rsl_rl stores per transition: reward, value, return, advantage, log-probability, done."""


def rollout_bytes(obs: TensorDict, num_actions: int, num_steps: int) -> int:
    """Return the bytes of rsl_rl's rollout storage.

    Args:
        obs: Observations of one step, batch of all worlds.
        num_actions: Size of the action.
        num_steps: Steps of one rollout.
    """
    tensors = [cast(torch.Tensor, value) for value in obs.values()]
    images_and_vectors = sum(tensor.element_size() * tensor.numel() for tensor in tensors)
    actions_mean_std = 3 * num_actions
    return num_steps * (images_and_vectors + 4 * obs.batch_size[0] * (actions_mean_std + _SCALARS))


def describe_rollout(obs: TensorDict, num_actions: int, num_steps: int) -> str:
    """Return one line for the start of a run: worlds, steps, groups and the memory they take."""
    groups = ", ".join(f"{name} {tuple(value.shape[1:])} {str(value.dtype)[6:]}" for name, value in obs.items())
    mebibytes = rollout_bytes(obs, num_actions, num_steps) / 2**20
    return f"rollout: {obs.batch_size[0]} worlds x {num_steps} steps, {mebibytes:.1f} MiB ({groups})"
