# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CNN model whose images are shifted at random while it learns."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.modules import HiddenState
from tensordict import TensorDict

from arcgym.rl.augmentation import random_shift
from arcgym.rl.models import ByteCnnModel


class AugmentedCnnModel(ByteCnnModel):
    """Byte CNN with random shifts in forward passes that gradients flow through; acting and export see plain images.

    In PPO the probability ratio then compares the shifted image with the plain one that was acted on. It is exact for
    soft actor-critic, cloning and distillation.
    """

    def __init__(
        self, obs: TensorDict, obs_groups: dict[str, list[str]], obs_set: str, *args: Any, shift: int = 0, **kwargs: Any
    ):
        """Build the model; other arguments as in :class:`arcgym.rl.models.ByteCnnModel`.

        Args:
            obs: Observations of one step.
            obs_groups: Observation groups of each set.
            obs_set: The set that this model reads.
            args: Further arguments of the byte CNN.
            shift: Largest random shift [px]; 0 switches it off.
            kwargs: Further arguments of the byte CNN.
        """
        super().__init__(obs, obs_groups, obs_set, *args, **kwargs)
        self.shift = shift

    def get_latent(
        self, obs: TensorDict, masks: torch.Tensor | None = None, hidden_state: HiddenState = None
    ) -> torch.Tensor:
        """Return the features of the images and the normalized vectors, shape (N, D).

        Beside a recurrent policy a model without memory is given whole rollouts, batch (T, N), and returns (T, N, D).
        """
        if obs.batch_dims > 1:
            return self.get_latent(obs.flatten(0, 1)).unflatten(0, obs.batch_size)
        return super().get_latent(self._augment(obs), masks, hidden_state)

    def _augment(self, obs: TensorDict) -> TensorDict:
        if self.shift == 0 or not (self.training and torch.is_grad_enabled()):
            return obs
        shifted = {name: random_shift(obs[name], self.shift) for name in self.obs_groups_2d}
        return TensorDict({**dict(obs.items()), **shifted}, batch_size=obs.batch_size)
