# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CNN followed by an LSTM or GRU, for policies with memory."""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.modules import RNN, HiddenState
from rsl_rl.utils import unpad_trajectories
from tensordict import TensorDict
from torch import nn

from arcgym.rl.networks.augmented_cnn import AugmentedCnnModel
from arcgym.rl.networks.exported_recurrent import JitRecurrentPolicy, OnnxRecurrentPolicy


class RecurrentCnnModel(AugmentedCnnModel):
    """Byte CNN, then a recurrent layer over its features and the vector groups, then the MLP.

    rsl_rl keeps the hidden state of each world while acting, clears it where an episode ends, and learns on the pieces
    of episodes that a rollout holds, each from the hidden state it began with.

    With ``skip_connection`` the MLP reads the features themselves and, behind them, the recurrent layer's output. A
    policy without memory can then be its start, see :func:`arcgym.rl.widened.with_memory`.
    """

    is_recurrent: bool = True

    def __init__(
        self,
        obs: TensorDict,
        obs_groups: dict[str, list[str]],
        obs_set: str,
        *args: Any,
        rnn_type: str = "lstm",
        rnn_hidden_dim: int = 256,
        rnn_num_layers: int = 1,
        skip_connection: bool = False,
        **kwargs: Any,
    ):
        """Build the model; other arguments as in :class:`AugmentedCnnModel`.

        Args:
            obs: Observations of one step.
            obs_groups: Observation groups of each set.
            obs_set: The set that this model reads.
            args: Further arguments of the CNN model.
            rnn_type: ``lstm`` or ``gru``.
            rnn_hidden_dim: Width of the hidden state.
            rnn_num_layers: Recurrent layers.
            skip_connection: Whether the MLP reads the features too, in front of the recurrent layer's output.
            kwargs: Further arguments of the CNN model.

        Raises:
            ValueError: If the type of the recurrent layer is unknown.
        """
        if rnn_type not in ("lstm", "gru"):
            raise ValueError(f"rnn_type is '{rnn_type}', expected one of: lstm, gru.")
        self.rnn_hidden_dim, self.skip_connection = rnn_hidden_dim, skip_connection
        super().__init__(obs, obs_groups, obs_set, *args, **kwargs)
        self.rnn = RNN(self.obs_dim + self.cnn_latent_dim, rnn_hidden_dim, rnn_num_layers, rnn_type)

    def get_latent(
        self, obs: TensorDict, masks: torch.Tensor | None = None, hidden_state: HiddenState = None
    ) -> torch.Tensor:
        """Return what the MLP reads: the recurrent layer's output, with ``skip_connection`` behind the features.

        Args:
            obs: Observations of N worlds, or pieces of episodes padded to T steps, batch (T, B).
            masks: Which steps of the pieces are real, bool, shape (T, B); None while acting.
            hidden_state: Hidden states that the pieces begin with.

        Returns:
            Shape (N, D) while acting, else (T, N, D) with the pieces put together again.
        """
        if masks is None:
            features = super().get_latent(obs)
            remembered = self.rnn(features).squeeze(0)
            return torch.cat([features, remembered], dim=-1) if self.skip_connection else remembered
        features = super().get_latent(obs[masks])
        padded = features.new_zeros(*masks.shape, features.shape[-1])
        padded[masks] = features
        remembered = self.rnn(padded, masks, hidden_state)
        if not self.skip_connection:
            return remembered
        return torch.cat([unpad_trajectories(padded, masks), remembered], dim=-1)  # type: ignore[list-item]

    def reset(self, dones: torch.Tensor | None = None, hidden_state: HiddenState = None) -> None:
        """Clear the hidden state of the worlds that are done, or set all of it."""
        self.rnn.reset(dones, hidden_state)

    def get_hidden_state(self) -> HiddenState:
        """Return the hidden state: (L, N, H), for an LSTM a pair of them, or None before the first step."""
        return self.rnn.hidden_state  # type: ignore[return-value]

    def detach_hidden_state(self, dones: torch.Tensor | None = None) -> None:
        """Cut the gradient through the hidden state."""
        self.rnn.detach_hidden_state(dones)

    def as_jit(self) -> nn.Module:
        """Return the deterministic policy for TorchScript; it keeps its hidden state until ``reset()``."""
        return JitRecurrentPolicy(self)

    def as_onnx(self, verbose: bool = False) -> nn.Module:
        """Return the deterministic policy for ONNX; the hidden state goes in and out."""
        return OnnxRecurrentPolicy(self)

    def _get_latent_dim(self) -> int:
        return self.rnn_hidden_dim + (super()._get_latent_dim() if self.skip_connection else 0)
