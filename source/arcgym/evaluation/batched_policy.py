# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A policy whose answer for a world does not depend on the number of worlds."""

from __future__ import annotations

import copy

import torch
from tensordict import TensorDict

from arcgym.rl.rollout import Policy

BATCH = 32
"""Worlds that go through the network together. Matrix products of another size may round otherwise."""


class BatchedPolicy:
    """Runs copies of a policy on batches of always the same size, the last one filled up with zeros.

    A policy with memory keeps that of each batch in a copy of its own.
    """

    def __init__(self, policy: Policy, num_envs: int, batch: int = BATCH) -> None:
        """Copy the policy.

        Args:
            policy: Maps observations of any number of worlds to raw actions, shape (N, A).
            num_envs: Number of worlds N.
            batch: Size of a batch.
        """
        self._batch = batch
        self._policies = [copy.deepcopy(policy) for _ in range(0, num_envs, batch)]

    def __call__(self, obs: TensorDict) -> torch.Tensor:
        """Return raw actions, shape (N, A)."""
        parts = [policy(self._part(obs, k)) for k, policy in enumerate(self._policies)]
        return torch.cat(parts)[: obs.batch_size[0]]

    def reset(self, dones: torch.Tensor) -> None:
        """Forget what policies with memory remember of the worlds whose episode ended, shape (N,)."""
        for k, policy in enumerate(self._policies):
            if hasattr(policy, "reset"):
                policy.reset(_filled(dones[k * self._batch : (k + 1) * self._batch], self._batch))

    def _part(self, obs: TensorDict, k: int) -> TensorDict:
        rows = slice(k * self._batch, (k + 1) * self._batch)
        values = {name: _filled(obs[name][rows], self._batch) for name in obs.keys()}  # noqa: SIM118 - a TensorDict
        return TensorDict(values, batch_size=[self._batch], device=obs.device)


def _filled(rows: torch.Tensor, size: int) -> torch.Tensor:
    """Return rows with zeros behind them up to a size."""
    if len(rows) == size:
        return rows
    return torch.cat([rows, rows.new_zeros(size - len(rows), *rows.shape[1:])])
