# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CNN model whose images change at random while it learns, and may be made smaller first."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.modules import HiddenState
from tensordict import TensorDict
from torch import nn

from arcgym.rl.augmentation import jitter_colors, random_shift, shrink_images
from arcgym.rl.models import ByteCnnModel


class ShrinkBytes(nn.Module):
    """Makes images smaller by :func:`arcgym.rl.augmentation.shrink_images`; those that are small already pass."""

    def __init__(self, factor: int, small_height: int):
        """Keep the edge of the blocks, and the height of images that pass."""
        super().__init__()
        self.factor, self.small_height = factor, small_height

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        """Return images of the small size, uint8, shape (N, C, h, w)."""
        if image.shape[-2] == self.small_height:
            return image
        return shrink_images(image, self.factor)


class AugmentedCnnModel(ByteCnnModel):
    """Byte CNN with random changes in forward passes that gradients flow through; acting and export see plain images.

    In PPO the probability ratio then compares the changed image with the plain one that was acted on. It is exact for
    soft actor-critic, cloning and distillation.
    """

    def __init__(
        self,
        obs: TensorDict,
        obs_groups: dict[str, list[str]],
        obs_set: str,
        *args: Any,
        shift: int = 0,
        color_jitter: float = 0.0,
        shrink: int = 1,
        **kwargs: Any,
    ):
        """Build the model; other arguments as in :class:`arcgym.rl.models.ByteCnnModel`.

        Args:
            obs: Observations of one step.
            obs_groups: Observation groups of each set.
            obs_set: The set that this model reads.
            args: Further arguments of the byte CNN.
            shift: Largest random shift [px]; 0 switches it off.
            color_jitter: Largest random change of brightness, contrast and saturation; 0 switches it off.
            shrink: Edge of the blocks of pixels that become one before the encoder; 1 leaves images as they are.
            kwargs: Further arguments of the byte CNN.
        """
        sizes = {name: tuple(obs[name].shape[-2:]) for name in obs_groups[obs_set] if obs[name].dim() == 4}
        smaller = {name: shrink_images(obs[name][:1], shrink).expand(len(obs), -1, -1, -1) for name in sizes}
        shown = obs if shrink == 1 else TensorDict({**dict(obs.items()), **smaller}, batch_size=obs.batch_size)
        super().__init__(shown, obs_groups, obs_set, *args, **kwargs)
        self.shift, self.color_jitter, self.shrink = shift, color_jitter, shrink
        if shrink > 1:
            for name, cnn in self.cnns.items():
                cnn.insert(0, ShrinkBytes(shrink, sizes[name][0] // shrink))
            self.obs_dims_2d = [sizes[name] for name in self.obs_groups_2d]

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
        if not (self.shift or self.color_jitter) or not (self.training and torch.is_grad_enabled()):
            return obs
        images = {name: obs[name] for name in self.obs_groups_2d}
        if self.color_jitter:
            images = {name: jitter_colors(image, self.color_jitter) for name, image in images.items()}
        if self.shift:
            images = {name: random_shift(image, self.shift) for name, image in images.items()}
        return TensorDict({**dict(obs.items()), **images}, batch_size=obs.batch_size)
