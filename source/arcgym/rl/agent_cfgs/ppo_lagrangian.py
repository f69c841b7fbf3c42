# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of PPO under limits on the cost of an episode."""

from __future__ import annotations

from arcgym.rl.model_cfg import RslRlMlpModelCfg
from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg, RslRlPpoAlgorithmCfg
from arcgym.utils.configclass import MISSING, configclass
from arcgym.utils.validation import (
    FieldError,
    Range,
    require,
    require_at_least,
    require_fraction,
    require_non_negative,
    require_positive,
)


@configclass
class MultiplierCfg:
    """What all kinds of multipliers share."""

    kind: str = MISSING
    """One of ``pid``, ``ascent``, ``fixed``."""

    init: float = 0.001
    """First value, in units of reward per unit of cost. Raise it where the first updates must be safe already."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require(self, "kind", ("pid", "ascent", "fixed"))
        require_non_negative(self, "init")
        if self.kind == "fixed" and self.init == MultiplierCfg.init:
            raise FieldError(self, "init", f"is {self.init} with the kind 'fixed', whose penalty it is: give another.")


@configclass
class PidMultiplierCfg(MultiplierCfg):
    """PID controller on the mean episode cost minus its limit (Stooke et al. 2020); constants as in OmniSafe."""

    kind: str = "pid"
    """Name of this rule; choose another class for another one."""

    kp: float = 0.1
    """Gain of the violation. Raise it when the cost swings around its limit."""

    ki: float = 0.01
    """Gain of the sum of all violations. Raise it when the cost stays above its limit for too long."""

    kd: float = 0.01
    """Gain of a rising cost. Raise it when the cost shoots over its limit."""

    smoothing: float = 0.95
    """Weight of the past in the running means, for each update in which episodes ended. Lower it for trainings of
    minutes."""

    delay: int = 10
    """Updates over which a rise of the cost is measured. Raise it when few episodes end in an update."""

    maximum: float = 100.0
    """Largest value of a multiplier. Lower it where the costs drown the reward."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require_non_negative(self, "kp", "ki", "kd")
        require(self, "smoothing", Range(0.0, 1.0, below=True))
        require_at_least(self, 1, "delay")
        require_positive(self, "maximum")


@configclass
class AscentMultiplierCfg(MultiplierCfg):
    """Plain gradient ascent on the mean episode cost minus its limit; constants as in OmniSafe."""

    kind: str = "ascent"
    """Name of this rule; choose another class for another one."""

    learning_rate: float = 0.035
    """Change of the multiplier for each unit of violation. Lower it when the cost swings around its limit."""

    maximum: float = 100.0
    """Largest value of a multiplier. Lower it where the costs drown the reward."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require_positive(self, "learning_rate", "maximum")


@configclass
class FixedPenaltyCfg(MultiplierCfg):
    """A constant penalty on the costs: the control that a constrained method has to beat."""

    kind: str = "fixed"
    """Name of this rule; choose another class for another one."""

    init: float = 1.0
    """The penalty, in units of reward per unit of cost. Raise it for a safer policy."""


@configclass
class RslRlPpoLagrangianAlgorithmCfg(RslRlPpoAlgorithmCfg):
    """PPO on the Lagrangian of reward and costs."""

    class_name: str = "arcgym.rl.algorithms.ppo_lagrangian:PPOLagrangian"
    """Algorithm class."""

    limits: dict[str, float] = MISSING
    """Largest mean episode cost of each constrained cost term of the task, in the unit that ``Episode_Cost/...`` is
    logged in: seconds for a term that is 1 while something is wrong. ``total`` is the sum of all terms."""

    multiplier: MultiplierCfg = PidMultiplierCfg()
    """How the multipliers move: :class:`PidMultiplierCfg`, :class:`AscentMultiplierCfg`, :class:`FixedPenaltyCfg`."""

    cost_gamma: float = 0.99
    """Discount of the costs. Nearer to one than the reward's, as the limit is on the undiscounted sum."""

    cost_lam: float = 0.95
    """Trace decay of the costs' advantages. Raise it for costs that follow late on what caused them."""

    min_episodes: int = 1
    """Episodes that must have ended before the multipliers move again. Raise it when single episodes vary a lot."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require_non_negative(self, "limits")
        require(self, "cost_gamma", Range(0.0, 1.0, above=True))
        require_fraction(self, "cost_lam")
        require_at_least(self, 1, "min_episodes")


@configclass
class RslRlPpoLagrangianRunnerCfg(RslRlOnPolicyRunnerCfg):
    """Runner of PPO with limits."""

    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoLagrangianAlgorithmCfg()
    """Learning algorithm."""

    cost_critic: RslRlMlpModelCfg | None = None
    """Value network of each cost; None takes the critic's. ``obs_groups["cost_critic"]`` names what it reads."""
