# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Round a surface by less than can be seen: USD packs arrays of few different numbers into smaller files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from arcgym.anatomy.stage.types import ContactSurface, VisualMesh

_POINT, _NORMAL, _UV, _WEIGHT = 2.0**-17, 2.0**-8, 2.0**-14, 2.0**-9
"""Steps to which is rounded: powers of two, as float32 holds them exactly."""


def quantize(visual: VisualMesh) -> VisualMesh:
    """Return the surface with rounded points (8 um), normals (0.2 deg), texture (1/12 px) and skin weights (0.2 %)."""
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


def quantize_contact(contact: ContactSurface) -> ContactSurface:
    """Return the surface with rounded points (8 um)."""
    return replace(contact, points=_rounded(contact.points, _POINT))


def _rounded(values: np.ndarray, step: float) -> np.ndarray:
    return (np.rint(values / step) * step).astype(np.float32)
