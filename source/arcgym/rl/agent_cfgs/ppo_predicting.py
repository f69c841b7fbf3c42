# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO whose policy also learns to predict what its critic sees."""

from __future__ import annotations

from arcgym.rl.runner_cfg import RslRlPpoAlgorithmCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_non_negative


@configclass
class RslRlPpoPredictingAlgorithmCfg(RslRlPpoAlgorithmCfg):
    """PPO with a head on the policy's last hidden layer that predicts the critic's observations."""

    class_name: str = "arcgym.rl.algorithms.ppo_predicting:PPOPredicting"
    """Algorithm class."""

    prediction_coef: float = 0.2
    """Weight of the mean squared difference, in standard deviations of each observation. Lower it where success falls
    while the prediction still gets better; 0 is plain PPO."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_non_negative(self, "prediction_coef")
