# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Normal distribution whose noise lasts longer than a step, so that more than a step's worth of it is tried."""

from __future__ import annotations

import math
from typing import Any

import torch

from arcgym.rl.networks.leaky_gaussian import LeakyGaussianDistribution


class CorrelatedGaussianDistribution(LeakyGaussianDistribution):
    """Leaky normal distribution whose noise is ``c`` times that of the last step and ``sqrt(1 - c^2)`` times new noise.

    Independent noise of 10 Hz hardly ever goes back for a second, as a nose in the wall would have to. Correlated noise
    does (Hollenstein et al. 2024, arXiv:2312.11091). Each action alone has the distribution that PPO takes it to have;
    its probability given the one before is not looked at, as there.
    """

    def __init__(self, output_dim: int, correlation: float = 0.6, **kwargs: Any) -> None:
        """Begin without a past.

        Args:
            output_dim: Number of actions A.
            correlation: Correlation c of the noise of two steps that follow each other, from 0 to below 1.
            kwargs: Further arguments of rsl_rl's ``GaussianDistribution``.
        """
        super().__init__(output_dim, **kwargs)
        self._keep, self._renew = correlation, math.sqrt(1.0 - correlation**2)
        self._noise: torch.Tensor | None = None

    def sample(self) -> torch.Tensor:
        """Return noisy actions, shape (N, A); where gradients flow, as in updates, nothing is remembered."""
        if torch.is_grad_enabled():
            return super().sample()
        noise = torch.randn_like(self.mean)
        if self._noise is not None and self._noise.shape == noise.shape:
            noise = self._keep * self._noise + self._renew * noise
        self._noise = noise
        return self.mean + self.std * noise
