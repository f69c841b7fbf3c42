# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A visual surface's triangles without its seam."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy import VisualMesh


def welded(visual: VisualMesh) -> np.ndarray:
    """Return the triangles with vertices at the same place (to 10 um) replaced by the first of them, shape (F, 3)."""
    _, first, place = np.unique(
        np.round(visual.points * 1e5).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return first[place.ravel()][visual.faces]
