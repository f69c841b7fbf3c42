# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rounds what nobody sees, so that stage files compress: USD packs arrays of few different numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from arcgym.anatomy.stage.types import VisualMesh

_POINT, _NORMAL, _UV, _WEIGHT = 2.0**-17, 2.0**-8, 2.0**-14, 2.0**-9


def compact(visual: VisualMesh) -> VisualMesh:
    """Returns the surface with points to 8 um, normals to 0.2 deg, a twelfth of a pixel, and skin weights to 0.2 %."""
    weights = np.rint(visual.skin_weights / _WEIGHT)
    weights[np.arange(len(weights)), weights.argmax(1)] += round(1.0 / _WEIGHT) - weights.sum(1)
    return replace(
        visual,
        points=_rounded(visual.points, _POINT),
        normals=_rounded(visual.normals, _NORMAL),
        uv=_rounded(visual.uv, _UV),
        tint=_rounded(visual.tint, _NORMAL),
        skin_weights=(weights * _WEIGHT).astype(np.float32),
    )


def _rounded(values: np.ndarray, step: float) -> np.ndarray:
    return (np.rint(values / step) * step).astype(np.float32)
