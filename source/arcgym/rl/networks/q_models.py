# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Action-value networks: models that read the action beside the observations."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import torch
from rsl_rl.models import MLPModel
from rsl_rl.modules import HiddenState
from rsl_rl.utils import resolve_nn_activation
from tensordict import TensorDict
from torch import nn

from arcgym.rl.networks.augmented_cnn import AugmentedCnnModel

ACTION = "action"
"""Group of the TensorDict that holds the action."""


def layer_norm_mlp(sizes: list[int], activation: str) -> nn.Sequential:
    """Return a perceptron with a LayerNorm before each activation.

    It keeps action values from running away on actions that were never tried (Ball et al. 2023, arXiv:2302.02948).

    Args:
        sizes: Width of input, hidden layers and output.
        activation: Name that rsl_rl resolves.
    """
    layers: list[nn.Module] = []
    for wide, next_wide in pairwise(sizes[:-1]):
        layers += [nn.Linear(wide, next_wide), nn.LayerNorm(next_wide), resolve_nn_activation(activation)]
    return nn.Sequential(*layers, nn.Linear(sizes[-2], sizes[-1]))


class _ReadsAction:
    """Appends the action to the features that a model computes from the observations."""

    num_actions: int

    def __init__(
        self,
        obs: TensorDict,
        obs_groups: dict[str, list[str]],
        obs_set: str,
        output_dim: int,
        hidden_dims: tuple[int, ...] | list[int] = (256, 256),
        activation: str = "elu",
        *args: Any,
        layer_norm: bool = True,
        **kwargs: Any,
    ):
        self.num_actions = obs[ACTION].shape[1]
        super().__init__(obs, obs_groups, obs_set, output_dim, hidden_dims, activation, *args, **kwargs)  # type: ignore
        if layer_norm:
            self.mlp = layer_norm_mlp([self._get_latent_dim(), *hidden_dims, output_dim], activation)

    def get_latent(
        self, obs: TensorDict, masks: torch.Tensor | None = None, hidden_state: HiddenState = None
    ) -> torch.Tensor:
        return torch.cat((super().get_latent(obs, masks, hidden_state), obs[ACTION]), dim=-1)  # type: ignore[misc]

    def _get_latent_dim(self) -> int:
        return super()._get_latent_dim() + self.num_actions  # type: ignore[misc]


class MlpQModel(_ReadsAction, MLPModel):
    """Action value from vector groups; ``layer_norm`` puts a LayerNorm before each activation."""


class CnnQModel(_ReadsAction, AugmentedCnnModel):
    """Action value from byte images, with vector groups beside them."""


def with_action(obs: TensorDict, actions: torch.Tensor) -> TensorDict:
    """Return the observations with the actions, shape (N, A), as one more group."""
    return TensorDict({**dict(obs.items()), ACTION: actions}, batch_size=obs.batch_size)
