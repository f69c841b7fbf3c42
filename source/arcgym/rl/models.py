# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Networks for rsl_rl that take camera images as bytes."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.models import CNNModel
from tensordict import TensorDict
from torch import nn

from arcgym.rl.exported_policy import JitImagePolicy, OnnxImagePolicy


class ByteToFloat(nn.Module):
    """Maps bytes 0..255 to floats -0.5..0.5, so that the first layer sees inputs centered on zero."""

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        """Return ``image`` as float32, same shape."""
        return image.to(torch.float32) / 255.0 - 0.5


class ByteCnnModel(CNNModel):
    """rsl_rl's CNN model for uint8 images of shape (N, C, H, W).

    The rollout storage keeps the dtype of the observations, so images stay one byte a value there and become floats
    only inside the network, one mini-batch at a time.
    """

    def __init__(self, obs: TensorDict, obs_groups: dict[str, list[str]], obs_set: str, *args: Any, **kwargs: Any):
        """Build the model; arguments as in rsl_rl's ``CNNModel``.

        Raises:
            TypeError: An image group is not uint8.
            ValueError: ``obs_normalization`` is on although the set has no vector group.
        """
        super().__init__(obs, obs_groups, obs_set, *args, **kwargs)
        self._check(obs, obs_set)
        for cnn in self.cnns.values():
            if not isinstance(cnn[0], ByteToFloat):
                cnn.insert(0, ByteToFloat())

    def as_jit(self) -> nn.Module:
        """Return the deterministic policy for TorchScript: ``forward(obs_1d, [image, ...])``."""
        return JitImagePolicy(self)

    def as_onnx(self, verbose: bool = False) -> nn.Module:
        """Return the deterministic policy for ONNX: ``forward(image, ..., obs_1d)``."""
        return OnnxImagePolicy(self)

    def _check(self, obs: TensorDict, obs_set: str) -> None:
        for group in self.obs_groups_2d:
            if obs[group].dtype != torch.uint8:
                raise TypeError(
                    f"Image group '{group}' of observation set '{obs_set}' is {obs[group].dtype}, expected torch.uint8 "
                    "of shape (N, C, H, W). Return bytes from the observation term, or set "
                    "agent.actor.class_name=CNNModel for float images."
                )
        if self.obs_normalization and not self.obs_groups:
            raise ValueError(
                f"Observation set '{obs_set}' has only images ({', '.join(self.obs_groups_2d)}), which "
                "obs_normalization does not apply to. Set obs_normalization=False or add a vector group."
            )
