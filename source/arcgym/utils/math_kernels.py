# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Functions on vectors that kernels of several rooms share."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def clamp_length(vector: wp.vec3, max_length: float) -> wp.vec3:
    """Return ``vector`` with its length clamped to ``max_length``."""
    length = wp.length(vector)
    if length > max_length:
        return vector * (max_length / length)
    return vector
