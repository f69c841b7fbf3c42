# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of the fidelity table and the checks that measure them. Importing this loads neither torch nor Warp."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np

Values: TypeAlias = "Sequence[float] | np.ndarray"
"""Numbers along an axis of a picture."""


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    """Name, by which ``--rows`` selects it."""
    value: float
    """Figure of the shipped solver with the shipped settings."""
    reference: float
    """Figure of the theory or of the converged reference."""
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
    """Return a row whose error is the relative deviation from the reference."""
    return Row(name, value, reference, value / reference - 1.0, bound, unit, note)


def absolute(name: str, value: float, reference: float, bound: float, unit: str = "", note: str = "") -> Row:
    """Return a row whose error is the deviation itself."""
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
    lines: list[tuple[str, Values, Values]] = field(default_factory=list)
    """(label, x, y) of references, drawn as lines."""
    points: list[tuple[str, Values, Values]] = field(default_factory=list)
    """(label, x, y) of the shipped solver, drawn as points."""
    bands: list[tuple[str, Values, Values, Values]] = field(default_factory=list)
    """(label, x, lower y, upper y) of published ranges, drawn as bands."""
    y_limit: float | None = None
    """Top of the picture; ``None`` shows everything."""


@dataclass
class Run:
    """Device and folder of the checks, and what they leave behind."""

    device: str
    """Device of the simulations."""
    folder: Path
    """Folder for the stages that they write."""
    plots: list[Plot] = field(default_factory=list)
    """Pictures of the checks done."""
    shared: dict[object, Any] = field(default_factory=dict)
    """Results that several checks use."""
    tables: dict[str, Any] = field(default_factory=dict)
    """Results with more figures than a row has, by name: plain values."""
    colons: tuple[str, ...] = ()
    """Stages of further colons that the search for contacts is checked in."""


@dataclass(frozen=True)
class Check:
    """A measurement that gives one or more rows."""

    rows: tuple[str, ...]
    """Names of its rows."""
    function: str
    """``module:name`` of a function in :mod:`arcgym.benchmarks.fidelity.checks` that takes a :class:`Run`."""
    params: dict[str, Any] = field(default_factory=dict)
    """Further arguments of the function."""
    quick: bool = False
    """Whether it takes seconds only."""

    def load(self) -> Callable[..., list[Row]]:
        """Return the function, imported."""
        module, _, name = self.function.partition(":")
        return getattr(importlib.import_module(f"arcgym.benchmarks.fidelity.checks.{module}"), name)

    def measure(self, run: Run) -> list[Row]:
        """Return the rows, measured.

        Raises:
            RuntimeError: If the function gives other rows than the table names.
        """
        rows = self.load()(run, **self.params)
        found = tuple(row.name for row in rows)
        if found != self.rows:
            raise RuntimeError(f"{self.function} gives the rows {found}; the table expects {self.rows}")
        return rows
