# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bounds of configuration fields and of term parameters, with messages that say what was given and expected."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from arcgym.utils.string import did_you_mean

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class Range:
    """Finite numbers from ``low`` to ``high``; ``value in Range(0.0, 1.0)`` tells whether one is inside."""

    low: float = -math.inf
    """Smallest number."""

    high: float = math.inf
    """Largest number."""

    above: bool = False
    """Whether ``low`` itself is outside."""

    below: bool = False
    """Whether ``high`` itself is outside."""

    def __contains__(self, value: Any) -> bool:
        """Return whether ``value`` is a finite number within the bounds."""
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            return False
        over = value > self.low if self.above else value >= self.low
        return over and (value < self.high if self.below else value <= self.high)

    def __str__(self) -> str:
        """Return the bounds in words, to follow "expected"."""
        low = f"above {self.low:g}" if self.above else f"at least {self.low:g}"
        high = f"below {self.high:g}" if self.below else f"at most {self.high:g}"
        parts = [text for text, bound in ((low, self.low), (high, self.high)) if math.isfinite(bound)]
        return "a number " + " and ".join(parts) if parts else "a finite number"


POSITIVE = Range(0.0, above=True)
"""Numbers above zero."""

NON_NEGATIVE = Range(0.0)
"""Numbers from zero on."""

FRACTION = Range(0.0, 1.0)
"""Numbers from zero to one."""

FINITE = Range()
"""Any number but infinity and NaN."""


class FieldError(ValueError):
    """A field holds a value that cannot be used; :func:`arcgym.utils.configclass.validate` adds the path to it.

    Attributes:
        field: Name of the field inside its configuration.
        text: Rest of the message, after the name.
    """

    def __init__(self, cfg: Any, field: str, text: str) -> None:
        """Name the field by its class; :attr:`text` follows it."""
        super().__init__(f"{type(cfg).__name__}.{field} {text}")
        self.field, self.text = field, text


def require(cfg: Any, name: str, expected: Range | Collection[str], unit: str = "") -> None:
    """Check a field; None passes, for optional fields, and each entry of a sequence or dict is checked.

    Args:
        cfg: Configuration.
        name: Name of its field.
        expected: Bounds of a number, or the names that a text may be.
        unit: Unit of the number, for the message.

    Raises:
        FieldError: With the field, its value, and what is expected or the nearest name.
    """
    for value in _entries(getattr(cfg, name)):
        if value is not None and not _fits(value, expected):
            raise FieldError(cfg, name, _mismatch(value, expected, unit))


def require_positive(cfg: Any, *names: str, unit: str = "") -> None:
    """Check that fields are above zero; see :func:`require`."""
    for name in names:
        require(cfg, name, POSITIVE, unit)


def require_non_negative(cfg: Any, *names: str, unit: str = "") -> None:
    """Check that fields are not below zero; see :func:`require`."""
    for name in names:
        require(cfg, name, NON_NEGATIVE, unit)


def require_fraction(cfg: Any, *names: str) -> None:
    """Check that fields are from zero to one; see :func:`require`."""
    for name in names:
        require(cfg, name, FRACTION)


def require_at_least(cfg: Any, low: int, *names: str, unit: str = "") -> None:
    """Check that fields are not below ``low``; see :func:`require`."""
    for name in names:
        require(cfg, name, Range(low), unit)


def require_ascending(cfg: Any, name: str, unit: str = "") -> None:
    """Check that a pair of numbers does not fall; None passes.

    Raises:
        FieldError: If the first is above the second, or there are not two.
    """
    value = getattr(cfg, name)
    if value is not None and len(value) != 2:
        raise FieldError(cfg, name, f"is {value}, expected two numbers.")
    if value is not None and not value[0] <= value[1]:
        raise FieldError(cfg, name, f"is {_shown(tuple(value), unit)}, expected the smaller number first.")


def require_order(cfg: Any, *names: str, unit: str = "") -> None:
    """Check that the values of several fields rise from each to the next.

    Raises:
        FieldError: With all of them.
    """
    values = [getattr(cfg, name) for name in names]
    for low, high, name in zip(values, values[1:], names[1:], strict=False):
        if not low < high:
            shown = " < ".join(f"{each} ({_shown(value, unit)})" for each, value in zip(names, values, strict=True))
            raise FieldError(cfg, name, f"is {_shown(high, unit)}, but {shown} must hold.")


def expects(**expected: Range | Collection[str]) -> Callable[[F], F]:
    """Decorate a term with what its parameters may be, for :func:`check_params` and the reference tables.

    Args:
        expected: By parameter: bounds of a number, or the names that a text may be. A parameter that takes either is
            checked against the names only where it is a text.
    """

    def decorate(term: F) -> F:
        setattr(term, "expected_params", expected)  # noqa: B010 - unknown to type checkers
        return term

    return decorate


def check_params(cfg: Any, func: Any, params: dict[str, Any]) -> None:
    """Check the parameters of a term against what :func:`expects` said; others pass.

    Args:
        cfg: The term's configuration, for the message.
        func: The term.
        params: Its parameters by name.

    Raises:
        FieldError: With the parameter, its value and what is expected.
    """
    expected = getattr(func, "expected_params", {})
    for name, value in params.items():
        bounds = expected.get(name)
        if bounds is None or value is None:
            continue
        for entry in _entries(value):
            is_either = not isinstance(bounds, Range) and not isinstance(entry, str)
            if not is_either and not _fits(entry, bounds):
                raise FieldError(cfg, f"params.{name}", _mismatch(entry, bounds, ""))


def _entries(value: Any) -> Iterable[Any]:
    if isinstance(value, dict):
        return value.values()
    return value if isinstance(value, (list, tuple)) else (value,)


def _fits(value: Any, expected: Range | Collection[str]) -> bool:
    return value in expected


def _mismatch(value: Any, expected: Range | Collection[str], unit: str) -> str:
    if isinstance(expected, Range):
        return f"is {_shown(value, unit)}, expected {expected}{f' {unit}' if unit else ''}."
    return f"is {value!r}. {did_you_mean(str(value), expected)}"


def _shown(value: Any, unit: str) -> str:
    return f"{value!r}{f' {unit}' if unit else ''}"
