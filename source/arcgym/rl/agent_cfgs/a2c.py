# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of advantage actor-critic."""

from __future__ import annotations

from arcgym.rl.runner_cfg import RslRlPpoAlgorithmCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_positive


@configclass
class RslRlA2cAlgorithmCfg(RslRlPpoAlgorithmCfg):
    """A2C (Mnih et al. 2016) with the settings that Stable-Baselines3 made common."""

    class_name: str = "arcgym.rl.algorithms.a2c:A2C"
    """Algorithm class."""

    num_learning_epochs: int = 1
    """Must be 1: A2C takes one step a rollout."""

    num_mini_batches: int = 1
    """Must be 1: A2C takes one step a rollout."""

    learning_rate: float = 7.0e-4
    """Learning rate. Lower it for rollouts of few worlds."""

    schedule: str = "fixed"
    """``adaptive`` has no effect worth having: the KL divergence is measured before the one step."""

    lam: float = 1.0
    """Trace decay; 1 is the n-step return of the original. Lower it for long rollouts."""

    use_clipped_value_loss: bool = False
    """Whether the value step is clipped; the original's is not. With one step there is nothing to clip."""

    value_loss_coef: float = 0.5
    """Weight of the value loss against the policy's. It matters where both share an encoder."""

    entropy_coef: float = 0.0
    """Weight of the entropy bonus. Raise it when the noise falls before anything is learnt."""

    max_grad_norm: float = 0.5
    """Largest norm of a gradient; larger ones are scaled down. Lower it if the loss jumps."""

    optimizer: str = "rmsprop"
    """Optimizer of the original. Its first step is ten times the learning rate; ``adam`` where a few updates drive the
    policy to the end of its range."""

    optimizer_eps: float = 1.0e-5
    """Term that keeps the optimizer's division finite. Raise it when the first steps are too large."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require(self, "num_learning_epochs", Range(1, 1))
        require(self, "num_mini_batches", Range(1, 1))
        require_positive(self, "optimizer_eps")
