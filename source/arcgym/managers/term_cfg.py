# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configurations of the terms that managers hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from arcgym.managers.noise import NoiseCfg
from arcgym.utils import MISSING, configclass
from arcgym.utils.validation import (
    FINITE,
    FieldError,
    check_params,
    require,
    require_ascending,
    require_at_least,
    require_fraction,
    require_non_negative,
    require_positive,
)

if TYPE_CHECKING:
    from arcgym.managers.action_manager import ActionTerm


@configclass
class ManagerTermBaseCfg:
    """A function and the parameters it is called with."""

    can_be_none: ClassVar[bool] = True
    """A term may be switched off with ``= None`` or ``null`` on the command line."""

    func: Callable[..., Any] = MISSING
    """Function, class derived from :class:`ManagerTermBase`, or the text ``"module:name"`` of either. Functions are
    called as ``func(env, **params)``; those of events and curricula as ``func(env, env_ids, **params)``. Values are
    copied when all terms of the manager were called: two terms must not return the same buffer."""

    params: dict[str, Any] = {}
    """Keyword arguments of the function. A :class:`SceneEntityCfg` among them is resolved once, at construction."""

    def validate_config(self) -> None:
        """Check the parameters that the term declares with :func:`arcgym.utils.validation.expects`.

        Raises:
            ValueError: If one is out of its bounds or names something unknown.
        """
        check_params(self, self.func, self.params)


@configclass
class RewardTermCfg(ManagerTermBaseCfg):
    """A reward: ``func`` returns one float a world, shape (N,)."""

    weight: float = 1.0
    """Factor of the value. Negative for penalties; zero skips the term, for a curriculum to switch it on."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require(self, "weight", FINITE)


@configclass
class CostTermCfg(ManagerTermBaseCfg):
    """A cost that constrained algorithms bound: ``func`` returns one float >= 0 a world, shape (N,)."""

    weight: float = 1.0
    """Factor of the value. Leave it at one to keep the cost in its own unit."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_non_negative(self, "weight")


@configclass
class TerminationTermCfg(ManagerTermBaseCfg):
    """A reason to end an episode: ``func`` returns one bool a world, shape (N,)."""

    time_out: bool = False
    """Whether the episode is cut short rather than lost: its value is then bootstrapped. True for time limits."""

    success: bool = False
    """Whether an episode that this term ends has reached its goal. Success rates and recorders count these."""


@configclass
class MetricsTermCfg(ManagerTermBaseCfg):
    """A figure to report: ``func`` returns one float a world, shape (N,); no learning depends on it."""

    reduce: Literal["mean", "last", "max", "sum"] = "mean"
    """How the values of an episode become one number: ``last`` for success, ``max`` for a peak force."""

    log: bool = True
    """Whether the mean over the episodes that end is logged. Switch it off for what has no mean, such as the number of
    a patient; the value of each episode is there all the same."""


@configclass
class EventTermCfg(ManagerTermBaseCfg):
    """A change of the scene: ``func(env, env_ids, **params)``."""

    mode: Literal["startup", "reset", "interval"] = MISSING
    """When it happens: once, at every reset of a world, or now and then during an episode."""

    interval_range_s: tuple[float, float] | None = None
    """Shortest and longest time between two events [s]; needed by mode ``interval``, ignored by the others."""

    is_global_time: bool = False
    """Whether all worlds share one interval timer that resets ignore, as for a change of the room's light."""

    min_step_count_between_reset: int = 0
    """Fewest control steps between two events of mode ``reset`` in one world. Raise it for expensive events."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require_positive(self, "interval_range_s", unit="s")
        require_ascending(self, "interval_range_s", unit="s")
        require_at_least(self, 0, "min_step_count_between_reset")
        if self.mode == "interval" and self.interval_range_s is None:
            raise FieldError(self, "interval_range_s", "is not set, but the mode 'interval' needs it [s].")


@configclass
class CurriculumTermCfg(ManagerTermBaseCfg):
    """A rule that changes the task as training goes on, called at resets: ``func(env, env_ids, **params)``.

    What it returns (a number, a dict of numbers or None) is logged.
    """


@configclass
class ActionTermCfg:
    """A part of the action vector and what it drives."""

    can_be_none: ClassVar[bool] = True
    """A term may be switched off with ``= None`` or ``null`` on the command line."""

    class_type: type[ActionTerm] | str = MISSING
    """Class of the term, or its text ``"module:name"``."""

    asset_name: str = MISSING
    """Name of the driven asset in the scene, e.g. ``"endoscope"``."""


@configclass
class ObservationTermCfg(ManagerTermBaseCfg):
    """An observation: ``func`` returns a tensor of shape (N, ...).

    It passes noise, clip, scale, delay and history, in this order. Images may stay uint8: then noise and scale are not
    allowed, and learners convert.
    """

    noise: NoiseCfg | None = None
    """Noise, added where the group's ``enable_corruption`` is set."""

    clip: tuple[float, float] | None = None
    """Bounds of the value, applied after the noise."""

    scale: float | tuple[float, ...] | None = None
    """Factor, or one for each entry of the last dimension, applied after the bounds."""

    delay_min_lag: int = 0
    """Smallest age of the observation [control steps]."""

    delay_max_lag: int = 0
    """Largest age of the observation [control steps]. Zero for none; set it to the latency of the real device."""

    delay_per_env: bool = True
    """Whether each world draws its own lag. Otherwise all have the same, which resets do not change."""

    delay_hold_prob: float = 0.0
    """Probability of keeping the lag when a new one is due, for latencies that vary slowly."""

    delay_update_period: int = 0
    """Control steps between new lags; zero draws one each step."""

    history_length: int = 0
    """Number of frames kept, oldest first. Zero for none. After a reset all are the first frame."""

    flatten_history_dim: bool = True
    """Whether the frames join the first dimension of the value: 5 frames of (3, H, W) become (15, H, W). Otherwise they
    are a dimension of their own: (5, 3, H, W)."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        super().validate_config()
        require(self, "clip", FINITE)
        require_ascending(self, "clip")
        require(self, "scale", FINITE)
        require_at_least(self, 0, "delay_min_lag", "delay_max_lag", "delay_update_period", "history_length")
        require_fraction(self, "delay_hold_prob")
        if self.delay_max_lag < self.delay_min_lag:
            text = f"is {self.delay_max_lag}, expected at least delay_min_lag, {self.delay_min_lag}."
            raise FieldError(self, "delay_max_lag", text)


@configclass
class ObservationGroupCfg:
    """Observations that go to the learner as one entry; terms are added as members of a subclass or in ``terms``."""

    can_be_none: ClassVar[bool] = True
    """A group may be switched off with ``= None`` or ``null`` on the command line."""

    concatenate_terms: bool = True
    """Whether the terms form one tensor; otherwise the group is a dict of them."""

    concatenate_dim: int = -1
    """Dimension of a term, not counting the worlds, along which terms are joined: -1 for vectors, 0 for images."""

    enable_corruption: bool = False
    """Whether the terms' noise is applied. Set it for training, not for evaluation."""

    history_length: int | None = None
    """Replaces the terms' own ``history_length``; None leaves them."""

    flatten_history_dim: bool = True
    """Replaces the terms' own ``flatten_history_dim`` where ``history_length`` is given here."""

    nan_policy: Literal["disabled", "warn", "sanitize", "error"] = "sanitize"
    """Treatment of values that are not finite: nothing, a message, a zero, or an exception. ``warn`` and ``error``
    wait for the device every step: use them to find the term that produces it."""

    terms: dict[str, ObservationTermCfg] = {}
    """Further terms by name."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 0, "history_length")
        require(self, "concatenate_dim", FINITE)
