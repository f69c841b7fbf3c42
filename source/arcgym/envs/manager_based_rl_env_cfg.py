# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of environments for reinforcement learning."""

from __future__ import annotations

from typing import Any

from arcgym.envs.manager_based_env_cfg import ManagerBasedEnvCfg
from arcgym.utils import MISSING, configclass
from arcgym.utils.validation import require_positive


@configclass
class ManagerBasedRLEnvCfg(ManagerBasedEnvCfg):
    """An environment with rewards, costs and episodes."""

    episode_length_s: float = MISSING
    """Longest episode [s]; rounded up to whole control steps."""

    is_finite_horizon: bool = False
    """Whether the time limit is part of the task. Otherwise learners bootstrap the value at time-outs."""

    rewards: Any = MISSING
    """Reward terms: a configuration class, or a dict, of :class:`RewardTermCfg`."""

    terminations: Any = MISSING
    """Termination terms: a configuration class, or a dict, of :class:`TerminationTermCfg`."""

    curriculum: Any = None
    """Curriculum terms: a configuration class, or a dict, of :class:`CurriculumTermCfg`; None for none."""

    costs: Any = None
    """Cost terms: a configuration class, or a dict, of :class:`CostTermCfg`; None for none."""

    metrics: Any = None
    """Metrics terms: a configuration class, or a dict, of :class:`MetricsTermCfg`; None for none."""

    scale_rewards_by_dt: bool = True
    """Whether rewards and costs are rates, multiplied by the control step: then their episode sums do not depend on
    the control frequency. Set it to False to reproduce work that adds up one value a step."""

    compute_final_obs: bool = False
    """Whether extras hold Gymnasium's ``final_obs`` and ``final_info``, observations and metrics before the reset, in
    steps where a world is done. Off-policy algorithms need it; it evaluates all observations a second time in those
    steps."""

    autoreset: bool = True
    """Whether a world that is done starts again within the step (Gymnasium's ``AutoresetMode.SAME_STEP``). False
    (``AutoresetMode.DISABLED``) leaves that to ``env.reset(options={"reset_mask": terminated | truncated})``, as
    Gymnasium's vector wrappers of observations want it."""

    @property
    def max_episode_length_s(self) -> float:
        """Longest episode [s]; a subclass may derive it from other fields."""
        return self.episode_length_s

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_positive(self, "episode_length_s", "max_episode_length_s", unit="s")
