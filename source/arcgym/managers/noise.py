# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Noise that corrupts observations."""

from __future__ import annotations

from typing import Literal

import torch

from arcgym.utils import configclass
from arcgym.utils.validation import FINITE, require, require_non_negative, require_order
from arcgym.utils.world_random import WorldRandom


@configclass
class NoiseCfg:
    """Base of all noises: how the drawn value meets the observation."""

    operation: Literal["add", "scale", "abs"] = "add"
    """Whether the noise is added, multiplied, or put in place of the value."""

    def sample(self, value: torch.Tensor, random: WorldRandom, tag: str) -> torch.Tensor:
        """Draw noise of the shape of ``value``, (N, ...).

        Args:
            value: Observation of every world.
            random: Random numbers of the worlds.
            tag: What the noise is for, to draw with.
        """
        raise NotImplementedError(f"{type(self).__name__} does not define sample.")

    def apply(self, value: torch.Tensor, random: WorldRandom, tag: str) -> torch.Tensor:
        """Return the corrupted value, in new memory; arguments as of :meth:`sample`."""
        noise = self.sample(value, random, tag)
        if self.operation == "add":
            return value + noise
        return value * noise if self.operation == "scale" else noise


@configclass
class ConstantNoiseCfg(NoiseCfg):
    """The same offset everywhere, as from a miscalibrated sensor."""

    bias: float = 0.0
    """Offset, in the unit of the observation."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "bias", FINITE)

    def sample(self, value: torch.Tensor, random: WorldRandom, tag: str) -> torch.Tensor:
        """Return the offset in the shape of ``value``."""
        return torch.full_like(value, self.bias)


@configclass
class UniformNoiseCfg(NoiseCfg):
    """Noise spread evenly between two bounds."""

    n_min: float = -1.0
    """Lower bound, in the unit of the observation."""

    n_max: float = 1.0
    """Upper bound, in the unit of the observation."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "n_min", FINITE)
        require(self, "n_max", FINITE)
        require_order(self, "n_min", "n_max")

    def sample(self, value: torch.Tensor, random: WorldRandom, tag: str) -> torch.Tensor:
        """Draw noise of the shape of ``value``."""
        return self.n_min + (self.n_max - self.n_min) * random.uniform(tag, *value.shape[1:])


@configclass
class GaussianNoiseCfg(NoiseCfg):
    """Normally distributed noise."""

    mean: float = 0.0
    """Mean, in the unit of the observation."""

    std: float = 1.0
    """Standard deviation, in the unit of the observation."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "mean", FINITE)
        require_non_negative(self, "std")

    def sample(self, value: torch.Tensor, random: WorldRandom, tag: str) -> torch.Tensor:
        """Draw noise of the shape of ``value``."""
        return self.mean + self.std * random.normal(tag, *value.shape[1:])
