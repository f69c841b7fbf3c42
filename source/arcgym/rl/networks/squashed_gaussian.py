# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Normal distribution squashed into [-1, 1] by a tanh, for soft actor-critic."""

from __future__ import annotations

import math

import torch
from rsl_rl.modules.distribution import Distribution
from torch import nn
from torch.distributions import Normal

_MIN_LOG_STD, _MAX_LOG_STD = -5.0, 2.0


class SquashedGaussianDistribution(Distribution):
    """Actions ``tanh(u)``, ``u`` normal with mean and deviation from the network (Haarnoja et al. 2018).

    Samples carry gradients. Log-probabilities are those of the squashed actions::

        log p(a) = log N(u) - sum log(1 - tanh(u)^2),  log(1 - tanh(u)^2) = 2 (log 2 - u - softplus(-2 u))
    """

    def __init__(self, output_dim: int, init_std: float = 1.0):
        """Start with deviations near ``init_std``.

        Args:
            output_dim: Size of the action.
            init_std: First standard deviation before squashing; 1 spreads actions almost evenly over [-1, 1].
        """
        super().__init__(output_dim)
        self.init_std = init_std
        self._mean = self._std = torch.empty(0)

    @property
    def input_dim(self) -> list[int]:
        """Shape of the network's output: means and logarithms of the deviations."""
        return [2, self.output_dim]

    @property
    def mean(self) -> torch.Tensor:
        """Squashed mean, shape (N, A)."""
        return torch.tanh(self._mean)

    @property
    def std(self) -> torch.Tensor:
        """Standard deviation before squashing, shape (N, A)."""
        return self._std

    @property
    def entropy(self) -> torch.Tensor:
        """Entropy estimated from one sample, shape (N,)."""
        return -self.sample_with_log_prob()[1]

    @property
    def params(self) -> tuple[torch.Tensor, ...]:
        """Mean and deviation before squashing."""
        return self._mean, self._std

    def update(self, mlp_output: torch.Tensor) -> None:
        """Take the network's output, shape (N, 2, A)."""
        self._mean = mlp_output[..., 0, :]
        self._std = mlp_output[..., 1, :].clamp(_MIN_LOG_STD, _MAX_LOG_STD).exp()

    def sample(self) -> torch.Tensor:
        """Return actions in [-1, 1], shape (N, A)."""
        return self.sample_with_log_prob()[0]

    def sample_with_log_prob(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Return actions, shape (N, A), and their log-probabilities, shape (N,), both with gradients."""
        raw = self._mean + self._std * torch.randn_like(self._mean)
        return torch.tanh(raw), self._raw_log_prob(raw)

    def log_prob(self, outputs: torch.Tensor) -> torch.Tensor:
        """Return the log-probabilities of actions in (-1, 1), shape (N,)."""
        limit = 1.0 - torch.finfo(outputs.dtype).eps
        return self._raw_log_prob(torch.atanh(outputs.clamp(-limit, limit)))

    def kl_divergence(self, old_params: tuple[torch.Tensor, ...], new_params: tuple[torch.Tensor, ...]) -> torch.Tensor:
        """Return KL(old || new), which squashing does not change, shape (N,)."""
        old, new = _normal(*old_params), _normal(*new_params)
        return torch.distributions.kl_divergence(old, new).sum(dim=-1)

    def deterministic_output(self, mlp_output: torch.Tensor) -> torch.Tensor:
        """Return the squashed mean, shape (N, A)."""
        return torch.tanh(mlp_output[..., 0, :])

    def as_deterministic_output_module(self) -> nn.Module:
        """Return :meth:`deterministic_output` as a module."""
        return _SquashedMean()

    def init_mlp_weights(self, mlp: nn.Module) -> None:
        """Set the last layer's bias to ``init_std``, and its weights for the deviation to zero."""
        last = [layer for layer in mlp.modules() if isinstance(layer, nn.Linear)][-1]
        with torch.no_grad():
            last.weight[self.output_dim :] = 0.0
            last.bias[self.output_dim :] = math.log(self.init_std)

    def _raw_log_prob(self, raw: torch.Tensor) -> torch.Tensor:
        change = 2.0 * (math.log(2.0) - raw - nn.functional.softplus(-2.0 * raw))
        return (_normal(self._mean, self._std).log_prob(raw) - change).sum(dim=-1)


class _SquashedMean(nn.Module):
    """Exportable squashed mean."""

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return torch.tanh(x[..., 0, :])


def _normal(mean: torch.Tensor, std: torch.Tensor) -> Normal:
    """Return a normal distribution that does not check its values, for which it would wait for the device."""
    return Normal(mean, std, validate_args=False)
