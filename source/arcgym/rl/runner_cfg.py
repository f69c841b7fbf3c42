# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Agent configurations for rsl_rl 5.5.

:meth:`RslRlOnPolicyRunnerCfg.to_dict` is the only place that knows rsl_rl's format.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from arcgym.rl.model_cfg import GaussianDistributionCfg, RslRlCnnModelCfg, RslRlMlpModelCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import (
    FieldError,
    Range,
    require,
    require_at_least,
    require_fraction,
    require_non_negative,
    require_positive,
)

LOG_WRITERS = {"wandb": "WandbLogWriter", "neptune": "NeptuneLogWriter"}
"""rsl_rl's writer by the name of the logger; ``tensorboard`` is its own."""


@configclass
class RslRlPpoAlgorithmCfg:
    """Proximal policy optimization (Schulman et al. 2017) as rsl_rl runs it."""

    class_name: str = "PPO"
    """Algorithm class: a name in rsl_rl or ``module:Class``; extra constructor arguments go in a subclass of this."""

    num_learning_epochs: int = 5
    """Passes over the rollout in one update. Lower it if the KL divergence is large."""

    num_mini_batches: int = 4
    """Mini-batches of one pass. More of them when a batch of images does not fit the device."""

    learning_rate: float = 3.0e-4
    """Learning rate; the first one when ``schedule`` is adaptive."""

    schedule: str = "adaptive"
    """``adaptive`` holds the KL divergence near ``desired_kl``, ``fixed`` keeps the learning rate."""

    desired_kl: float = 0.01
    """KL divergence of one update that the adaptive schedule aims at. Lower it for steadier learning."""

    gamma: float = 0.99
    """Discount of one control step. Raise it with the length of the task; near one, waiting where rewards are small
    costs little."""

    lam: float = 0.95
    """Trace decay of generalized advantage estimation (Schulman et al. 2016). Lower it where returns vary a lot."""

    clip_param: float = 0.2
    """Clipping range of the probability ratio and, with ``use_clipped_value_loss``, of the value step. Lower it for
    steadier learning."""

    entropy_coef: float = 0.005
    """Weight of the entropy bonus. Must match the reward's scale: too large and the noise never falls."""

    value_loss_coef: float = 1.0
    """Weight of the value loss against the policy's. Lower it if a shared encoder serves the critic alone."""

    use_clipped_value_loss: bool = True
    """Whether the value step is clipped. Turn off where values are much larger than ``clip_param``: the critic cannot
    follow then."""

    max_grad_norm: float = 1.0
    """Largest norm of a gradient; larger ones are scaled down. Lower it if the loss jumps."""

    optimizer: str = "adam"
    """Optimizer that rsl_rl resolves (``adam``, ``adamw``, ``sgd``, ``rmsprop``)."""

    normalize_advantage_per_mini_batch: bool = False
    """Whether advantages are normalized in each mini-batch rather than over the rollout."""

    use_mixed_precision: bool = False
    """Whether updates compute in bfloat16 (``torch.autocast``); acting stays in float32. Turn on where ``arcgym bench
    learner`` shows that it pays, and compare the curves: it rounds the policy's mean to 8 bits."""

    share_cnn_encoders: bool = False
    """Whether the critic uses the actor's encoders; both sets must then name the same image groups."""

    def validate_config(self) -> None:
        """Check numbers and names.

        Raises:
            FieldError: A value is out of range.
        """
        require_at_least(self, 1, "num_learning_epochs", "num_mini_batches")
        require_positive(self, "learning_rate", "desired_kl", "clip_param", "max_grad_norm")
        require_fraction(self, "lam")
        require(self, "gamma", Range(0.0, 1.0, above=True))
        require(self, "schedule", ("adaptive", "fixed"))
        require(self, "optimizer", ("adam", "adamw", "sgd", "rmsprop"))
        require_non_negative(self, "entropy_coef", "value_loss_coef")


@configclass
class RslRlOnPolicyRunnerCfg:
    """Everything about learning: runner, models and algorithm."""

    class_name: str = "arcgym.rl.runner:OnPolicyRunner"
    """Runner class that the scripts construct, as ``module:Class``."""

    seed: int = 42
    """Seed of networks and environment; ``--seed`` overrides it."""

    num_steps_per_env: int = 24
    """Control steps that each world contributes to one update."""

    max_iterations: int = 500
    """Updates of a full training run."""

    max_minutes: float | None = None
    """Minutes of learning after which a run ends, resumed parts included; None has no such end. Building the worlds
    does not count. Set it to compare unlike algorithms at equal time."""

    max_transitions: int | None = None
    """Transitions after which a run ends, resumed parts included, with the update that reaches them; None has no such
    end. Set it to compare unlike algorithms at equal experience."""

    save_interval: int = 50
    """Updates between two checkpoints; the last one is always kept."""

    experiment_name: str = "arcgym"
    """Folder below ``logs/rsl_rl`` that collects the runs of one experiment."""

    run_name: str = ""
    """Suffix of the run's folder, after its time stamp."""

    logger: str = "tensorboard"
    """``tensorboard``, ``wandb`` or ``neptune``."""

    log_project_name: str = "arcgym"
    """Project name for ``wandb`` and ``neptune``."""

    obs_groups: dict[str, list[str]] = {"actor": ["policy"], "critic": ["critic"]}
    """Observation groups that each model reads."""

    actor: RslRlMlpModelCfg = RslRlCnnModelCfg(distribution_cfg=GaussianDistributionCfg())
    """Policy network."""

    critic: RslRlMlpModelCfg = RslRlMlpModelCfg()
    """Value network; must have no distribution."""

    algorithm: RslRlPpoAlgorithmCfg = RslRlPpoAlgorithmCfg()
    """Learning algorithm."""

    clip_actions: float | None = None
    """Bound on the raw actions' magnitude, applied by the environment wrapper; None leaves them to the action terms."""

    init_at_random_ep_len: bool = True
    """Whether the worlds start at random places of their time limit, so that time-outs do not come all at once."""

    final_learning_rate: float | None = None
    """Learning rate at the end of ``max_iterations``, or of ``max_minutes`` or ``max_transitions`` if that comes first,
    reached on a line from ``algorithm.learning_rate``; None keeps it constant. Set it for long runs that get worse
    late. Needs the schedule ``fixed``."""

    check_for_nan: bool = True
    """Whether the runner stops at a NaN in observation or reward. The environment resets broken worlds before that."""

    store_git_diff: bool = False
    """Whether the uncommitted changes of the checkout are stored with the run. Off, as they may hold private work."""

    torch_compile_mode: str | None = None
    """Mode of ``torch.compile`` for actor and critic; None runs them eagerly."""

    init_policy: str | None = None
    """Checkpoint whose policy a new run starts from, of behavior cloning, of a distillation (its student), or of
    another task; None starts from scratch. The student of a distillation may start from one, too. A policy without
    memory fits one with it whose ``skip_connection`` is on, and a policy of images one that reads vectors besides
    (``agent.obs_groups.actor``)."""

    critic_first: int = 0
    """Updates at the start of a run with ``init_policy`` in which the critics alone learn. A good policy gets worse
    first where its critic knows nothing; ten updates show the critic what the policy earns. PPO and its relatives."""

    resume: bool = False
    """Whether to go on from ``load_run``/``load_checkpoint``; set by ``--resume``."""

    load_run: str = ".*"
    """Run folder to resume from: a name or a regular expression, the newest match wins."""

    load_checkpoint: str = "latest"
    """Checkpoint to resume from: a file name, ``latest`` or ``best``."""

    def validate_config(self) -> None:
        """Check numbers and names.

        Raises:
            FieldError: A value is out of range.
        """
        require_at_least(self, -1, "seed")
        require_at_least(self, 1, "num_steps_per_env", "max_iterations", "max_transitions", "save_interval")
        require(self, "logger", ("tensorboard", *LOG_WRITERS))
        require_positive(self, "clip_actions", "max_minutes")
        require_non_negative(self, "final_learning_rate")
        require_at_least(self, 0, "critic_first")
        for name in ("experiment_name", "run_name"):
            value = getattr(self, name)
            if "/" in value or value.startswith("."):
                raise FieldError(self, name, f"is '{value}', expected a name without '/' and no '.' in front.")
        if not self.experiment_name:
            raise FieldError(self, "experiment_name", "is empty, expected a name.")

    def to_dict(self) -> dict[str, Any]:
        """Return the training dictionary that rsl_rl 5.5 accepts: None entries left out, logger in its own format."""
        result = _strip(self)
        result["logger"] = _logger(self.logger, self.log_project_name)
        return result


def _strip(value: Any) -> Any:
    """Convert nested configs to dictionaries without their None entries, which rsl_rl's constructors reject."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        return {name: _strip(item) for name, item in fields.items() if item is not None}
    if isinstance(value, dict):
        return {key: _strip(item) for key, item in value.items() if item is not None}
    if isinstance(value, (list, tuple)):
        return [_strip(item) for item in value]
    return value


def _logger(name: str, project: str) -> str | dict[str, str]:
    """Return rsl_rl's logger entry."""
    if name == "tensorboard":
        return name
    if name not in LOG_WRITERS:
        raise ValueError(f"agent.logger is '{name}', expected one of: tensorboard, {', '.join(LOG_WRITERS)}.")
    return {"class_name": LOG_WRITERS[name], "project_name": project}
