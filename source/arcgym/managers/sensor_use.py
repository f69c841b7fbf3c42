# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tells which terms can be evaluated before the sensors are read."""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any, TypeVar

Term = TypeVar("Term", bound=Callable[..., Any])


def reads_no_sensor(term: Term) -> Term:
    """Decorate a term, function or class, that looks at no sensor of the scene, such as the camera.

    Where all terminations are such terms, a step knows which worlds are done while their pictures are still being
    drawn, and prepares the resets meanwhile. A subclass has to be decorated itself.
    """
    setattr(term, "looks_at_sensors", False)  # noqa: B010 - unknown to type checkers
    return term


def may_read_sensors(term: Any) -> bool:
    """Return whether a resolved term, a function or an object of its class, was not decorated."""
    marks = vars(term) if isinstance(term, FunctionType) else vars(type(term))
    return bool(marks.get("looks_at_sensors", True))
