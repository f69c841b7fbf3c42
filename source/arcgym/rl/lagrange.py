# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Multipliers of constraints: prices of a cost that rise while it is above its limit and fall while it is below."""

from __future__ import annotations

import inspect
from collections import deque
from typing import Any, Protocol


class Multiplier(Protocol):
    """Price of one cost in units of reward per unit of cost; never negative."""

    value: float
    """The price now."""

    def update(self, cost: float) -> None:
        """Take in the mean episode cost of the policy."""

    def state_dict(self) -> dict[str, Any]:
        """Return what :meth:`load_state_dict` needs to go on from here."""

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Go on from a saved state."""


class GradientAscentMultiplier:
    """Projected gradient ascent on the dual: ``value += learning_rate (cost - limit)``, kept within [0, maximum].

    Plain steps and not Adam's, which on a single number have the same length whatever the violation.
    """

    def __init__(self, limit: float, init: float = 0.001, learning_rate: float = 0.035, maximum: float = 100.0):
        """Start at ``init``. The defaults are those of OmniSafe (Ji et al. 2024) for a cost in units of episodes."""
        self.limit, self.learning_rate, self.maximum = limit, learning_rate, maximum
        self.value = init

    def update(self, cost: float) -> None:
        """Take one step along the violation of the mean episode cost."""
        self.value = _clamp(self.value + self.learning_rate * (cost - self.limit), self.maximum)

    def state_dict(self) -> dict[str, Any]:
        """Return the value."""
        return {"value": self.value}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Restore the value."""
        self.value = state["value"]


class PidMultiplier:
    """PID controller on the violation (Stooke, Achiam and Abbeel 2020, arXiv:2007.03964).

    With the violation ``e = cost - limit`` and running means ``m(x) <- smoothing m(x) + (1 - smoothing) x``::

        value = clamp(kp m(e) + I + kd max(0, m(cost) - m(cost) of delay updates ago), 0, maximum)
        I     = clamp(I + ki e, 0, maximum)

    The derivative acts on rising cost only. The proportional part damps the swings of plain ascent, which integrates.
    The integral has the bounds of the value, so that it has nothing to make up for when the cost falls.
    """

    def __init__(
        self,
        limit: float,
        init: float = 0.001,
        kp: float = 0.1,
        ki: float = 0.01,
        kd: float = 0.01,
        smoothing: float = 0.95,
        delay: int = 10,
        maximum: float = 100.0,
    ):
        """Start with the integral at ``init``; the defaults are OmniSafe's."""
        self.limit, self.kp, self.ki, self.kd = limit, kp, ki, kd
        self.smoothing, self.maximum = smoothing, maximum
        self.value = init
        self._integral = init
        self._error = self._cost = 0.0
        self._past: deque[float] = deque([0.0], maxlen=delay)

    def update(self, cost: float) -> None:
        """Take in the mean episode cost."""
        error, old = cost - self.limit, self.smoothing
        self._integral = _clamp(self._integral + self.ki * error, self.maximum)
        self._error = old * self._error + (1.0 - old) * error
        self._cost = old * self._cost + (1.0 - old) * cost
        rise = max(0.0, self._cost - self._past[0])
        self._past.append(self._cost)
        self.value = _clamp(self.kp * self._error + self._integral + self.kd * rise, self.maximum)

    def state_dict(self) -> dict[str, Any]:
        """Return value, integral, means and past."""
        return {
            "value": self.value,
            "integral": self._integral,
            "error": self._error,
            "cost": self._cost,
            "past": list(self._past),
        }

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Restore value, integral, means and past."""
        self.value, self._integral = state["value"], state["integral"]
        self._error, self._cost = state["error"], state["cost"]
        self._past = deque(state["past"], maxlen=self._past.maxlen)


class FixedMultiplier:
    """A price that never moves: the cost as a penalty in the reward, the control of every constrained method."""

    def __init__(self, limit: float, init: float):
        """Set the price; the limit is only for the record."""
        self.limit, self.value = limit, init

    def update(self, cost: float) -> None:
        """Do nothing."""

    def state_dict(self) -> dict[str, Any]:
        """Return the value."""
        return {"value": self.value}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Keep the configured value: a resumed run may be given another one."""


def make_multiplier(kind: str, limit: float, **settings: Any) -> Multiplier:
    """Return a multiplier.

    Args:
        kind: ``ascent``, ``pid`` or ``fixed``.
        limit: Largest mean episode cost that is allowed.
        settings: Further arguments of its class. Those of the other kinds are left out, so that ``kind`` alone may be
            changed in a configuration.

    Raises:
        ValueError: If the kind is unknown.
    """
    kinds = {"ascent": GradientAscentMultiplier, "pid": PidMultiplier, "fixed": FixedMultiplier}
    if kind not in kinds:
        raise ValueError(f"Multiplier of kind '{kind}', expected one of: {', '.join(kinds)}.")
    known = inspect.signature(kinds[kind]).parameters
    return kinds[kind](limit, **{name: value for name, value in settings.items() if name in known})


def _clamp(value: float, maximum: float) -> float:
    return min(max(value, 0.0), maximum)
