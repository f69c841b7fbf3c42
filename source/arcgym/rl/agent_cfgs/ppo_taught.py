# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO whose policy is also drawn to what a teacher would do."""

from __future__ import annotations

from arcgym.rl.agent_cfgs.ppo_bounded import RslRlPpoBoundedAlgorithmCfg
from arcgym.rl.model_cfg import GaussianDistributionCfg, RslRlMlpModelCfg
from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import require_non_negative


@configclass
class RslRlPpoTaughtAlgorithmCfg(RslRlPpoBoundedAlgorithmCfg):
    """PPO with bounded means and a teacher, see :class:`arcgym.rl.algorithms.ppo_taught.PPOTaught`."""

    class_name: str = "arcgym.rl.algorithms.ppo_taught:PPOTaught"
    """Algorithm class."""

    lesson_coef: float = 1.0
    """Weight of the squared difference between mean actions and the teacher's, at the beginning. Lower it where success
    falls at first. 0 is ``ppo_bounded``."""

    final_lesson_coef: float = 0.0
    """The weight at the end of ``max_iterations``, ``max_minutes`` or ``max_transitions``, whichever comes first,
    reached on a line. Raise it where the policy gets worse as the lesson fades."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_non_negative(self, "lesson_coef", "final_lesson_coef")


@configclass
class RslRlTaughtRunnerCfg(RslRlOnPolicyRunnerCfg):
    """Runner of PPO with a teacher."""

    class_name: str = "arcgym.rl.taught_runner:TaughtRunner"
    """Runner class."""

    teacher_checkpoint: str = ""
    """Checkpoint of a PPO run whose actor has the shape of ``teacher``. Must be set, unless the run is resumed."""

    obs_groups: dict[str, list[str]] = {"actor": ["policy"], "critic": ["critic"], "teacher": ["critic"]}
    """Observation groups that each model reads."""

    teacher: RslRlMlpModelCfg = RslRlMlpModelCfg(
        obs_normalization=True, distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )
    """Policy that says what it would do. Without memory."""
