# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recurrent image policies without rsl_rl around them, in the form that TorchScript and ONNX can hold."""

from __future__ import annotations

import copy
from typing import Any

import torch
from torch import nn


class _RecurrentPolicy(nn.Module):
    """Copies of the parts that act. The state is one tensor (N, S, L, H): S is 2 for an LSTM (hidden, cell), else 1."""

    def __init__(self, model: Any):
        super().__init__()
        self.obs_normalizer = copy.deepcopy(model.obs_normalizer)
        self.cnns = nn.ModuleList([copy.deepcopy(model.cnns[group]) for group in model.obs_groups_2d])
        self.rnn = copy.deepcopy(model.rnn.rnn)
        self.mlp = copy.deepcopy(model.mlp)
        self.skip_connection = bool(model.skip_connection)
        has_distribution = model.distribution is not None
        self.output = model.distribution.as_deterministic_output_module() if has_distribution else nn.Identity()
        self.state_shape = (2 if isinstance(self.rnn, nn.LSTM) else 1, self.rnn.num_layers, self.rnn.hidden_size)

    def latent(self, features: torch.Tensor, remembered: torch.Tensor) -> torch.Tensor:
        """Return what the MLP reads, shape (N, D): the recurrent layer's output, or features and it."""
        return torch.cat([features, remembered], dim=-1) if self.skip_connection else remembered


class _LstmStep(nn.Module):
    """One step of an LSTM with its state in one tensor."""

    def __init__(self, rnn: nn.LSTM):
        super().__init__()
        self.rnn = rnn

    def forward(self, x: torch.Tensor, state: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        hidden, cell = state[:, 0].transpose(0, 1).contiguous(), state[:, 1].transpose(0, 1).contiguous()
        out, (hidden, cell) = self.rnn(x.unsqueeze(0), (hidden, cell))
        return out.squeeze(0), torch.stack((hidden.transpose(0, 1), cell.transpose(0, 1)), dim=1)


class _GruStep(nn.Module):
    """One step of a GRU with its state in the same layout."""

    def __init__(self, rnn: nn.GRU):
        super().__init__()
        self.rnn = rnn

    def forward(self, x: torch.Tensor, state: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        out, hidden = self.rnn(x.unsqueeze(0), state[:, 0].transpose(0, 1).contiguous())
        return out.squeeze(0), hidden.transpose(0, 1).unsqueeze(1)


def _step_module(rnn: nn.Module) -> nn.Module:
    return _LstmStep(rnn) if isinstance(rnn, nn.LSTM) else _GruStep(rnn)  # type: ignore[arg-type]


class JitRecurrentPolicy(_RecurrentPolicy):
    """TorchScript form, with the signature of the CNN policies; keeps the state of N worlds between calls."""

    def __init__(self, model: Any):
        """Copy the model; the state starts at zero."""
        super().__init__(model)
        self.step = _step_module(self.rnn)
        self.state: torch.Tensor
        self.register_buffer("state", torch.zeros(1, *self.state_shape), persistent=False)

    def forward(self, obs_1d: torch.Tensor, obs_2d: list[torch.Tensor]) -> torch.Tensor:
        """Return the mean action, shape (N, A), and remember; another number of worlds N starts from zero.

        Args:
            obs_1d: Vector observations, shape (N, D); D is 0 for a policy that sees images only.
            obs_2d: uint8 images, each of shape (N, C, H, W), in the order of the observation set.
        """
        latents = [self.obs_normalizer(obs_1d)]
        for i, cnn in enumerate(self.cnns):
            latents.append(cnn(obs_2d[i]))
        x = torch.cat(latents, dim=-1)
        if self.state.shape[0] != x.shape[0]:
            shape = [x.shape[0], self.state.shape[1], self.state.shape[2], self.state.shape[3]]
            self.state = torch.zeros(shape, dtype=x.dtype, device=x.device)
        remembered, self.state = self.step(x, self.state)
        return self.output(self.mlp(self.latent(x, remembered)))

    @torch.jit.export
    def reset(self) -> None:
        """Forget everything; call it when an episode starts."""
        self.state = torch.zeros_like(self.state)


class OnnxRecurrentPolicy(_RecurrentPolicy):
    """ONNX form: images, then ``obs`` where vectors are read, then ``state_in``; gives ``actions``, ``state_out``."""

    def __init__(self, model: Any):
        """Copy the model and remember the shapes of its inputs."""
        super().__init__(model)
        self.step = _step_module(self.rnn)
        self.image_names = list(model.obs_groups_2d)
        self.image_shapes = [
            (channels, *size) for channels, size in zip(model.obs_channels_2d, model.obs_dims_2d, strict=True)
        ]
        self.vector_size = int(model.obs_dim)

    def forward(self, *inputs: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return the mean action, shape (N, A), and the next state, shape (N, S, L, H); a zero state is a new start."""
        latents = [cnn(image) for cnn, image in zip(self.cnns, inputs, strict=False)]
        if self.vector_size:
            latents.insert(0, self.obs_normalizer(inputs[-2]))
        x = torch.cat(latents, dim=-1)
        remembered, state = self.step(x, inputs[-1])
        return self.output(self.mlp(self.latent(x, remembered))), state

    def get_dummy_inputs(self) -> tuple[torch.Tensor, ...]:
        """Return inputs of the right shapes for tracing, batch of two."""
        images = [torch.zeros(2, *shape, dtype=torch.uint8) for shape in self.image_shapes]
        vectors = [torch.zeros(2, self.vector_size)] if self.vector_size else []
        return (*images, *vectors, torch.zeros(2, *self.state_shape))

    @property
    def input_names(self) -> list[str]:
        """Names of the inputs, in order."""
        return [*self.image_names, *(["obs"] if self.vector_size else []), "state_in"]

    @property
    def output_names(self) -> list[str]:
        """Names of the outputs."""
        return ["actions", "state_out"]
