# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""PPO whose policy also learns to say what its critic sees."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from rsl_rl.utils import reduce_gradients_in_buckets
from torch import nn

from arcgym.rl.algorithms.further_loss import FurtherLoss
from arcgym.rl.networks.feature_reader import FeatureReader
from arcgym.utils.errors import UsageError

FARTHEST = 5.0
"""Standard deviations at which what is to be predicted is cut."""


class PPOPredicting(PPO):
    """PPO with one more loss: a linear head on the policy's last hidden layer predicts the critic's observations.

    In the simulator the critic sees where the lumen is while the camera sees a wall. Telling that from images is taught
    directly, as an auxiliary task (Jaderberg et al. 2017, arXiv:1611.05397), where reward teaches it by the way. The
    head is dropped where the policy acts, which sees images alone.
    """

    def __init__(
        self, actor: MLPModel, critic: MLPModel, storage: RolloutStorage, prediction_coef: float = 0.2, **kwargs: Any
    ):
        """Build PPO and the head.

        Args:
            actor: Policy without memory.
            critic: Value function with normalized vector observations, which are what is predicted.
            storage: Rollout storage.
            prediction_coef: Weight of the mean squared difference, in standard deviations of each observation.
            kwargs: Further arguments of PPO.

        Raises:
            UsageError: A network has a memory, or the critic's observations are not normalized.
        """
        if actor.is_recurrent or critic.is_recurrent:
            raise UsageError("PPOPredicting draws single steps, expected models without memory, such as ByteCnnModel.")
        if not critic.obs_normalization:
            raise UsageError("PPOPredicting needs the scale of what it predicts: set agent.critic.obs_normalization.")
        super().__init__(actor, critic, storage, **kwargs)
        self.head = nn.Linear(actor.mlp[-1].in_features, critic.obs_dim).to(self.device)
        self.optimizer.add_param_group({"params": self.head.parameters()})
        self.features = FeatureReader(actor.mlp[-1])
        self.symmetry = _Prediction(self, prediction_coef)  # type: ignore[assignment]

    def update(self) -> dict[str, float]:
        """Make the gradient steps of an iteration and return the mean losses."""
        with self.features:
            losses = super().update()
        losses["prediction"] = losses.pop("symmetry")
        return losses

    def save(self) -> dict:
        """Return PPO's state and the head's."""
        return {**super().save(), "head_state_dict": self.head.state_dict()}

    def load(self, loaded_dict: dict, load_cfg: dict | None, strict: bool) -> bool:
        """Load a checkpoint; the head with the optimizer."""
        if load_cfg is None or load_cfg.get("optimizer"):
            self.head.load_state_dict(loaded_dict["head_state_dict"])
        return super().load(loaded_dict, load_cfg, strict)

    def broadcast_parameters(self) -> None:
        """Send the models of the first process to all."""
        super().broadcast_parameters()
        for tensor in self.head.state_dict().values():
            torch.distributed.broadcast(tensor, src=0)

    def reduce_parameters(self) -> None:
        """Average the gradients over all processes."""
        super().reduce_parameters()
        reduce_gradients_in_buckets(self.head.parameters(), self.gpu_world_size, self.grad_reduce_bucket_mb)


class _Prediction(FurtherLoss):
    """Teaches the head, and through it the features."""

    def __init__(self, alg: PPOPredicting, coef: float):
        super().__init__(coef)
        self.alg = alg

    def compute_loss(self, actor: MLPModel, batch: Any, size: int) -> torch.Tensor:
        """Return the mean squared difference; the policy has just seen this mini-batch."""
        critic = self.alg.critic
        with torch.no_grad():
            target = critic.get_latent(batch.observations).clamp(-FARTHEST, FARTHEST)
        return (self.alg.head(self.alg.features.last) - target).square().mean()
