# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO whose mean actions stay within what is carried out."""

from __future__ import annotations

from arcgym.rl.runner_cfg import RslRlPpoAlgorithmCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_non_negative


@configclass
class RslRlPpoBoundedAlgorithmCfg(RslRlPpoAlgorithmCfg):
    """PPO whose means are drawn back into [-1, 1], see :class:`arcgym.rl.algorithms.ppo_bounded.PPOBounded`."""

    class_name: str = "arcgym.rl.algorithms.ppo_bounded:PPOBounded"
    """Algorithm class."""

    bounds_loss_coef: float = 1.0
    """Weight of the squared difference between mean actions and what was carried out. Raise it where the logged
    ``bounds`` stays above 0.1, lower it where learning gets slow. 0 is plain PPO."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_non_negative(self, "bounds_loss_coef")
