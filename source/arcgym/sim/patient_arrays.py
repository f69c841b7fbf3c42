# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of what belongs to a patient, one entry a patient along the last dimension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


def patient_array(values: Sequence[np.ndarray], dtype: Any, device: str) -> wp.array:
    """Copy an array of each of P patients to the device.

    Neighboring threads work on neighboring worlds, which have neighboring patients at the start: the patient is the
    last index, so that they read neighboring memory.

    Args:
        values: Array of each patient, shape ``(..., *d)``, d the shape of a vector or matrix, () for numbers, structs.
        dtype: Warp type of an element.
        device: Warp device.

    Returns:
        Shape (..., P).
    """
    inner = getattr(dtype, "_shape_", ())
    stacked = np.stack([np.asarray(value) for value in values], axis=values[0].ndim - len(inner))
    return wp.array(np.ascontiguousarray(stacked), dtype=dtype, device=device)
