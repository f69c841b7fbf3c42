# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO whose policy is also told what to do where it is lost."""

from __future__ import annotations

from arcgym.rl.agent_cfgs.ppo_bounded import RslRlPpoBoundedAlgorithmCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_non_negative


@configclass
class RslRlPpoTaughtAlgorithmCfg(RslRlPpoBoundedAlgorithmCfg):
    """PPO with bounded means and a lesson, see :class:`arcgym.rl.algorithms.ppo_taught.PPOTaught`."""

    class_name: str = "arcgym.rl.algorithms.ppo_taught:PPOTaught"
    """Algorithm class."""

    lesson_coef: float = 1.0
    """Weight of the squared difference between mean actions and the lesson's, where there is one. Lower it where the
    lesson's way is worse than what reward finds. 0 is ``ppo_bounded``."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_non_negative(self, "lesson_coef")
