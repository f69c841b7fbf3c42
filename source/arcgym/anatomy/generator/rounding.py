# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rounding that takes away how processors and libraries differ in the last digits of sines, exponentials and sums."""

from __future__ import annotations

import numpy as np

STEP = 1e-6
"""Distance of rounded positions [m]: some 1e10 times those differences, which hardly ever cross a border then, and far
below anything of a colon."""


def rounded(values: np.ndarray, step: float = STEP) -> np.ndarray:
    """Return the nearest multiples of a step, shape kept."""
    return np.rint(values / step) * step
