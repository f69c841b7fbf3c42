# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Advantage actor-critic on PPO's code."""

from __future__ import annotations

from typing import Any

from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from tensordict import TensorDict

from arcgym.utils.errors import UsageError


class A2C(PPO):
    """Synchronous advantage actor-critic (Mnih et al. 2016): one gradient step on the whole rollout.

    With one epoch and one batch the probability ratio is one, so that PPO's clipping has no effect and its surrogate
    has the gradient of the policy-gradient loss (Huang et al. 2022, arXiv:2205.09123). Advantages stay as they are,
    unless ``normalize_advantage_per_mini_batch`` scales those of the one batch.
    """

    def __init__(
        self,
        actor: MLPModel,
        critic: MLPModel,
        storage: RolloutStorage,
        num_learning_epochs: int = 1,
        num_mini_batches: int = 1,
        optimizer_eps: float = 1.0e-5,
        **kwargs: Any,
    ):
        """Build PPO with A2C's settings.

        Args:
            actor: Policy.
            critic: Value function.
            storage: Rollout storage.
            num_learning_epochs: Must be 1.
            num_mini_batches: Must be 1.
            optimizer_eps: Term that keeps the optimizer's division finite; RMSprop's is larger than torch's default.
            kwargs: Further arguments of PPO.

        Raises:
            UsageError: If there is more than one epoch or batch.
        """
        for name, value in (("num_learning_epochs", num_learning_epochs), ("num_mini_batches", num_mini_batches)):
            if value != 1:
                raise UsageError(f"A2C takes one gradient step a rollout: {name} is {value}, expected 1; or use PPO.")
        super().__init__(actor, critic, storage, num_learning_epochs, num_mini_batches, **kwargs)
        for group in self.optimizer.param_groups:
            if "eps" in group:
                group["eps"] = optimizer_eps

    def compute_returns(self, obs: TensorDict) -> None:
        """Compute returns and advantages, without PPO's scaling of the advantages."""
        super().compute_returns(obs)
        self.storage.advantages = self.storage.returns - self.storage.values
