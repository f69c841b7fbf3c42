# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of behavior cloning and distillation."""

from __future__ import annotations

from typing import Any

from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg
from arcgym.rl.model_cfg import GaussianDistributionCfg, RslRlMlpModelCfg
from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import FieldError, require, require_at_least, require_non_negative, require_positive


@configclass
class RslRlBehaviorCloningAlgorithmCfg:
    """Supervised learning of recorded actions."""

    class_name: str = "arcgym.rl.algorithms.behavior_cloning:BehaviorCloning"
    """Algorithm class."""

    demonstrations: str = ""
    """Folder of recorded episodes with ``obs/<group>`` for every group that the actor reads, or ``expert``: the robot's
    scripted expert is asked when learning begins. Must be set."""

    successful_only: bool = True
    """Whether episodes that did not succeed are left out. Turn off where the recorded ones end before the goal."""

    expert_steps: int = 20_000
    """Steps that the expert is asked for, at least. A step of five images of 84×84 takes 106 kB of the device."""

    expert_noise: float = 0.2
    """Standard deviation of the noise on the expert's actions as they are carried out, in raw actions, so that it shows
    how to get back from mistakes (DART, arXiv:1703.09327). Zero shows its own way alone."""

    expert_settings: dict[str, float] = {}
    """Settings of the scripted expert, by the names of its arguments; others keep their defaults. Set
    ``{speed: -0.005, sweep: 0.8}`` for a capsule that looks around on its way back."""

    asks_on: bool = False
    """Whether the expert goes on to say what it would do where the policy drives between updates, which is cloned, too
    (DAgger, Ross et al. 2011, arXiv:1011.0686). Needs ``demonstrations=expert``. A clone of the expert's own way alone
    does not know how to get back onto it; give the policy time to come to where it errs by ``num_steps_per_env``."""

    learning_rate: float = 3.0e-4
    """Learning rate. Lower it if the loss jumps."""

    batch_size: int = 256
    """Recorded steps of one gradient step. Raise it on a GPU that waits between steps."""

    steps_per_update: int = 100
    """Gradient steps of one iteration. Raise it where the loss still falls at the end."""

    max_grad_norm: float = 1.0
    """Largest norm of a gradient; larger ones are scaled down. Lower it if the loss jumps."""

    action_units: str = "raw"
    """What a difference of actions is counted in. ``raw``: as it is. ``deviation``: each action in its own standard
    deviation over the demonstrations, so that slow motions count as much as fast turns (a withdrawal goes back with a
    tenth of its range of actions and turns with nine); see
    :class:`arcgym.rl.algorithms.behavior_cloning.BehaviorCloning`."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 1, "expert_steps", "batch_size", "steps_per_update")
        require(self, "action_units", ("raw", "deviation"))
        if self.asks_on and self.demonstrations != "expert":
            raise FieldError(
                self, "asks_on", f"is true with demonstrations '{self.demonstrations}', expected 'expert'."
            )
        require_positive(self, "learning_rate", "max_grad_norm")
        require_non_negative(self, "expert_noise")


@configclass
class RslRlBehaviorCloningRunnerCfg(RslRlOnPolicyRunnerCfg):
    """Runner of behavior cloning; the steps in the environment only show how good the policy is."""

    class_name: str = "arcgym.rl.behavior_cloning_runner:BehaviorCloningRunner"
    """Runner class."""

    num_steps_per_env: int = 4
    """Control steps of each world between updates. More make the curves of success less noisy."""

    actor: RslRlMlpModelCfg = AugmentedCnnModelCfg(distribution_cfg=GaussianDistributionCfg(init_std=0.3))
    """Policy network. Give it the shape of the PPO policy that it is to start."""

    critic: Any = None
    """None: nothing here has a value."""

    algorithm: Any = RslRlBehaviorCloningAlgorithmCfg()
    """Learning algorithm."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds, or the network is to be compiled, which this runner does not.
        """
        super().validate_config()
        if self.torch_compile_mode is not None:
            raise FieldError(
                self, "torch_compile_mode", f"is '{self.torch_compile_mode}', expected None: cloning has none."
            )


@configclass
class RslRlDistillationAlgorithmCfg:
    """rsl_rl's distillation: the student acts and is taught what the teacher would have done."""

    class_name: str = "Distillation"
    """Algorithm class."""

    num_learning_epochs: int = 2
    """Passes over the rollout in one update. Raise it for a simulator that is slower than the learner."""

    gradient_length: int = 4
    """Steps whose losses are added up for one gradient step, and through which a recurrent student remembers. Must
    divide ``num_learning_epochs * num_steps_per_env``."""

    learning_rate: float = 3.0e-4
    """Learning rate. Lower it if the loss jumps."""

    max_grad_norm: float = 1.0
    """Largest norm of a gradient; larger ones are scaled down. Lower it if the loss jumps."""

    loss_type: str = "mse"
    """``mse``, or ``huber`` where single actions of the teacher lie far off."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_at_least(self, 1, "num_learning_epochs", "gradient_length")
        require_positive(self, "learning_rate", "max_grad_norm")
        require(self, "loss_type", ("mse", "huber"))


@configclass
class RslRlDistillationRunnerCfg(RslRlOnPolicyRunnerCfg):
    """Runner of distillation from a privileged teacher."""

    class_name: str = "arcgym.rl.distillation_runner:DistillationRunner"
    """Runner class."""

    teacher_checkpoint: str = ""
    """Checkpoint of a PPO run whose actor has the shape of ``teacher``. Must be set, unless the run is resumed."""

    obs_groups: dict[str, list[str]] = {"student": ["policy"], "teacher": ["critic"]}
    """Observation groups that each model reads."""

    actor: Any = None
    """None: the policies are ``student`` and ``teacher``."""

    critic: Any = None
    """None: nothing here has a value."""

    student: RslRlMlpModelCfg = AugmentedCnnModelCfg(distribution_cfg=GaussianDistributionCfg(init_std=0.1))
    """Policy to learn; its deviation is the noise it acts with."""

    teacher: RslRlMlpModelCfg = RslRlMlpModelCfg(
        obs_normalization=True, distribution_cfg=GaussianDistributionCfg(init_std=0.6)
    )
    """Policy to imitate."""

    algorithm: Any = RslRlDistillationAlgorithmCfg()
    """Learning algorithm."""

    def validate_config(self) -> None:
        """Check bounds, and that every step of a rollout is learnt from.

        Raises:
            ValueError: If a value is out of its bounds, or steps would be left over.
        """
        super().validate_config()
        steps = self.algorithm.num_learning_epochs * self.num_steps_per_env
        if steps % self.algorithm.gradient_length:
            raise FieldError(
                self.algorithm,
                "gradient_length",
                f"is {self.algorithm.gradient_length}, expected a divisor of num_learning_epochs * num_steps_per_env, "
                f"{steps}.",
            )
