# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Deterministic image policies without rsl_rl around them, in the form that TorchScript and ONNX can hold."""

from __future__ import annotations

import copy

import torch
from rsl_rl.models import CNNModel
from torch import nn


class _ImagePolicy(nn.Module):
    """Copies of the parts that act; the critic, the noise and the optimizer stay behind."""

    def __init__(self, model: CNNModel):
        super().__init__()
        self.obs_normalizer = copy.deepcopy(model.obs_normalizer)
        self.cnns = nn.ModuleList([copy.deepcopy(model.cnns[group]) for group in model.obs_groups_2d])
        self.mlp = copy.deepcopy(model.mlp)
        has_distribution = model.distribution is not None
        self.output = model.distribution.as_deterministic_output_module() if has_distribution else nn.Identity()


class JitImagePolicy(_ImagePolicy):
    """TorchScript form, with rsl_rl's signature for CNN policies."""

    def forward(self, obs_1d: torch.Tensor, obs_2d: list[torch.Tensor]) -> torch.Tensor:
        """Return the mean action, shape (N, A).

        Args:
            obs_1d: Vector observations, shape (N, D); D is 0 for a policy that sees images only.
            obs_2d: uint8 images, each of shape (N, C, H, W), in the order of the observation set.
        """
        latents = [self.obs_normalizer(obs_1d)]
        for i, cnn in enumerate(self.cnns):
            latents.append(cnn(obs_2d[i]))
        return self.output(self.mlp(torch.cat(latents, dim=-1)))

    @torch.jit.export
    def reset(self) -> None:
        """Do nothing: the policy has no memory."""


class OnnxImagePolicy(_ImagePolicy):
    """ONNX form: one uint8 input per image group, then ``obs`` where the policy also reads vectors."""

    def __init__(self, model: CNNModel):
        """Copy the model and remember the shapes of its inputs."""
        super().__init__(model)
        self.image_names = list(model.obs_groups_2d)
        self.image_shapes = [
            (channels, *size) for channels, size in zip(model.obs_channels_2d, model.obs_dims_2d, strict=True)
        ]
        self.vector_size = int(model.obs_dim)

    def forward(self, *inputs: torch.Tensor) -> torch.Tensor:
        """Return the mean action, shape (N, A)."""
        latents = [cnn(image) for cnn, image in zip(self.cnns, inputs, strict=False)]
        if self.vector_size:
            latents.insert(0, self.obs_normalizer(inputs[-1]))
        return self.output(self.mlp(torch.cat(latents, dim=-1)))

    def get_dummy_inputs(self) -> tuple[torch.Tensor, ...]:
        """Return inputs of the right shapes for tracing, batch of two."""
        images = [torch.zeros(2, *shape, dtype=torch.uint8) for shape in self.image_shapes]
        vectors = [torch.zeros(2, self.vector_size)] if self.vector_size else []
        return (*images, *vectors)

    @property
    def input_names(self) -> list[str]:
        """Names of the inputs, in order."""
        return [*self.image_names, *(["obs"] if self.vector_size else [])]

    @property
    def output_names(self) -> list[str]:
        """Name of the output."""
        return ["actions"]
