# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A figure and the bound that it has to keep."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Check:
    """One figure and the bound that it has to keep."""

    name: str
    """What is checked."""
    value: float
    """What was found."""
    bound: float
    """What is allowed."""
    at_least: bool
    """Whether the bound is a minimum rather than a maximum."""

    @property
    def ok(self) -> bool:
        """Whether the figure keeps its bound; a figure that is not finite never does."""
        kept = self.value >= self.bound if self.at_least else self.value <= self.bound
        return bool(np.isfinite(self.value)) and kept

    def __str__(self) -> str:
        """One line with figure and bound, or the name alone where there is nothing to measure."""
        if np.isnan(self.value) and np.isnan(self.bound):
            return self.name
        return f"{self.name} {self.value:.4g} (must be {'>=' if self.at_least else '<='} {self.bound:.4g})"


def failed(checks: Iterable[Check]) -> list[Check]:
    """Return the checks that are not kept."""
    return [check for check in checks if not check.ok]
