# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configuration of soft actor-critic."""

from __future__ import annotations

from typing import Any

from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg
from arcgym.rl.model_cfg import CnnCfg, RslRlMlpModelCfg
from arcgym.rl.runner_cfg import RslRlOnPolicyRunnerCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import FINITE, Range, require, require_at_least, require_positive


@configclass
class SquashedGaussianDistributionCfg:
    """Normal distribution through a tanh: actions stay in [-1, 1]."""

    class_name: str = "arcgym.rl.networks.squashed_gaussian:SquashedGaussianDistribution"
    """Distribution class."""

    init_std: float = 1.0
    """First standard deviation before squashing; 1 spreads actions almost evenly. Lower it for a policy that begins
    with small motions."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_positive(self, "init_std")


@configclass
class MlpQModelCfg(RslRlMlpModelCfg):
    """Action value from vector groups, such as the privileged state."""

    class_name: str = "arcgym.rl.networks.q_models:MlpQModel"
    """Model class."""

    layer_norm: bool = True
    """Whether a LayerNorm comes before each activation. Off only to reproduce older results."""


@configclass
class CnnQModelCfg(AugmentedCnnModelCfg):
    """Action value from images, with an encoder for each critic. Slower; for tasks without a privileged state."""

    class_name: str = "arcgym.rl.networks.q_models:CnnQModel"
    """Model class."""

    layer_norm: bool = True
    """Whether a LayerNorm comes before each activation. Off only to reproduce older results."""


@configclass
class RslRlSacAlgorithmCfg:
    """Soft actor-critic for many worlds; rates as in Squint (arXiv:2602.21203), without its distributional critic."""

    class_name: str = "arcgym.rl.algorithms.sac:SAC"
    """Algorithm class."""

    replay_size: int = 400_000
    """Observations to keep, of all worlds together, on the training device. A frame of 84×84 takes 21 kB, so that a
    million takes 21 GB."""

    frame_stacks: dict[str, int] = {}
    """Frames in the channels of each stacked image group, as ``history_length`` of its term; each is stored once."""

    gamma: float = 0.97
    """Discount of one control step. Raise it with the length of the task: rewards that lie far ahead count more, and
    targets vary more."""

    learning_rate: float = 3.0e-4
    """Learning rate of actor, critics and temperature. Lower it if ``Loss/value`` grows."""

    batch_size: int = 512
    """Transitions of one gradient step. Raise it on a GPU that waits between steps."""

    updates_per_transition: float = 0.25
    """Gradient steps for each new transition. Lower it when the simulator waits for the learner."""

    learning_starts: int = 10_000
    """Transitions with random actions before the first gradient step. Lower it where ``init_policy`` acts already."""

    actor_interval: int = 4
    """Critic steps for each step of actor and temperature. Lower it for critics that learn fast."""

    target_step: float = 0.01
    """Fraction by which the target critics follow in each step. Lower it when values grow without bound."""

    init_temperature: float = 0.1
    """First temperature, in units of reward per nat; the only one with ``learn_temperature`` off."""

    learn_temperature: bool = True
    """Whether the temperature holds the entropy at ``target_entropy``. Turn off for the fixed one of the ARCGym
    paper."""

    target_entropy: float | None = None
    """Entropy to hold [nat]; None is minus the size of the action. Raise it for a policy that explores longer."""

    max_grad_norm: float = 10.0
    """Largest norm of a gradient; larger ones are scaled down. Lower it if the loss jumps."""

    num_steps: int = 1
    """Steps whose rewards a target adds up before it bootstraps. 3 spreads rewards faster, and is off-policy: the steps
    in between are those of older policies, and their entropy does not count."""

    use_mixed_precision: bool = False
    """Whether the networks compute in bfloat16 in updates; losses and distributions stay in float32. Turn on where
    ``arcgym bench learner`` shows that it pays."""

    use_cuda_graphs: bool = True
    """Whether gradient steps on one GPU are replayed as CUDA graphs: hundreds of small launches become one. Turn off to
    find errors. Without effect on the CPU, with several processes, and beside ``torch_compile_mode``."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        require_at_least(self, 1, "replay_size", "frame_stacks", "batch_size", "actor_interval", "num_steps")
        require(self, "gamma", Range(0.0, 1.0, above=True))
        require_positive(self, "learning_rate", "updates_per_transition", "init_temperature", "max_grad_norm")
        require_at_least(self, 0, "learning_starts")
        require(self, "target_step", Range(0.0, 1.0, above=True))
        require(self, "target_entropy", FINITE, unit="nat")


@configclass
class RslRlSacRunnerCfg(RslRlOnPolicyRunnerCfg):
    """Runner of soft actor-critic: one step of all worlds, then the gradient steps that its transitions call for."""

    class_name: str = "arcgym.rl.off_policy_runner:OffPolicyRunner"
    """Runner class."""

    num_steps_per_env: int = 8
    """Control steps of each world between two visits to the learner; also the iterations that logs count. Raise it
    with few worlds."""

    actor: RslRlMlpModelCfg = AugmentedCnnModelCfg(
        hidden_dims=[256],
        activation="relu",
        cnn_cfg=CnnCfg(activation="relu"),
        distribution_cfg=SquashedGaussianDistributionCfg(),  # type: ignore[arg-type]
    )
    """Policy network; its distribution must be a squashed one."""

    critic: RslRlMlpModelCfg = MlpQModelCfg(hidden_dims=[256, 256], activation="relu", obs_normalization=True)
    """Each of the two action-value networks."""

    algorithm: Any = RslRlSacAlgorithmCfg()
    """Learning algorithm."""

    save_replay: bool = False
    """Whether the memory is saved with every checkpoint, so that a resumed run goes on at once. Takes
    ``replay_size`` images of disk."""


@configclass
class RslRlDistributionalSacAlgorithmCfg(RslRlSacAlgorithmCfg):
    """Soft actor-critic with categorical critics, as in Squint: more robust to the scale of the reward's tail."""

    class_name: str = "arcgym.rl.algorithms.distributional_sac:DistributionalSAC"
    """Algorithm class."""

    num_atoms: int = 101
    """Atoms of the distribution of the return. Raise it with a wider ``value_range``."""

    value_range: list[float] = [-25.0, 25.0]
    """First and last atom, in units of discounted return; untrained critics answer its middle. Widen it when
    ``Loss/value`` comes near an end."""
