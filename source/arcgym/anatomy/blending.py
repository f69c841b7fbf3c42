# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Smooth steps, elementwise."""

from __future__ import annotations

import numpy as np


def smooth_step(low: float, high: float, x: np.ndarray) -> np.ndarray:
    """Return 0 below ``low``, 1 above ``high`` and the cubic ``t^2 (3 - 2 t)`` between, shape like ``x``."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
