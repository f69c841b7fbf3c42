# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of the fidelity table, and the checks that make them. Importing this loads neither torch nor Warp."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    """What ``--rows`` selects it by."""
    value: float
    """What the shipped solver gives with the shipped settings."""
    reference: float
    """What it ought to be."""
    error: float
    """Deviation: relative if the bound is, else in the row's unit."""
    bound: float
    """Largest error that passes."""
    unit: str = ""
    """Unit of value and reference."""
    note: str = ""
    """Anything a reader of the table should know."""
    relative: bool = True
    """Whether error and bound are fractions of the reference."""

    @property
    def ok(self) -> bool:
        """Whether the error is finite and within its bound."""
        return math.isfinite(self.error) and abs(self.error) <= self.bound


def relative(name: str, value: float, reference: float, bound: float, unit: str = "", note: str = "") -> Row:
    """Row whose error is the relative deviation from the reference."""
    return Row(name, value, reference, value / reference - 1.0, bound, unit, note)


def absolute(name: str, value: float, reference: float, bound: float, unit: str = "", note: str = "") -> Row:
    """Row whose error is the deviation itself."""
    return Row(name, value, reference, value - reference, bound, unit, note, relative=False)


@dataclass
class Plot:
    """A picture of one check: lines and points of x and y."""

    name: str
    """Name of its file."""
    x_label: str
    """Quantity and unit."""
    y_label: str
    """Quantity and unit."""
    lines: list[tuple[str, Sequence[float], Sequence[float]]] = field(default_factory=list)
    """(label, x, y) of references, drawn as lines."""
    points: list[tuple[str, Sequence[float], Sequence[float]]] = field(default_factory=list)
    """(label, x, y) of the shipped solver, drawn as points."""
    bands: list[tuple[str, Sequence[float], Sequence[float], Sequence[float]]] = field(default_factory=list)
    """(label, x, lower y, upper y) of published ranges, drawn as bands."""
    y_limit: float | None = None
    """Top of the picture; ``None`` shows everything."""


@dataclass
class Run:
    """Where the checks run and what they leave behind."""

    device: str
    """Device of the simulations."""
    folder: Path
    """Folder for the stages that they write."""
    plots: list[Plot] = field(default_factory=list)
    """Pictures of the checks done."""
    shared: dict[object, Any] = field(default_factory=dict)
    """Results that several checks use."""


@dataclass(frozen=True)
class Check:
    """A measurement that gives one or more rows."""

    rows: tuple[str, ...]
    """Names of its rows."""
    measure: Callable[[Run], list[Row]]
    """Makes them."""
    quick: bool
    """Whether it takes seconds only."""


CHECKS: list[Check] = []
"""All checks, in the order of the table."""


def check(*rows: str, quick: bool = False) -> Callable[[Callable[[Run], list[Row]]], Callable[[Run], list[Row]]]:
    """Decorator that enters a function into :data:`CHECKS`."""

    def enter(measure: Callable[[Run], list[Row]]) -> Callable[[Run], list[Row]]:
        CHECKS.append(Check(rows, measure, quick))
        return measure

    return enter
