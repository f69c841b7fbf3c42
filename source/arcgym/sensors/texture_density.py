# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How finely a texture lies on a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh


def texel_density(visual: VisualMesh, width: int, height: int) -> np.ndarray:
    """Returns the texels per metre at every vertex along the texture's denser axis, shape (M,), float64.

    The renderer picks the level of the texture pyramid by it. It is taken at rest, as the mean over the triangles
    around a vertex, so that levels change smoothly over the surface; where u crowds (a pole) it is large, which
    blends the crowded texels instead of showing them as streaks.
    """
    corner = visual.points[visual.faces].astype(np.float64)
    uv = visual.uv[visual.faces].astype(np.float64) * (width, height)
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = np.cross(e1, e2)
    area_sq = np.maximum((area**2).sum(axis=1), 1.0e-24)
    along = np.cross(d1[:, :, None] * e2[:, None] - d2[:, :, None] * e1[:, None], area[:, None])
    density = np.linalg.norm(along, axis=2).max(axis=1) / area_sq
    weight = np.sqrt(area_sq)
    total, weights = np.zeros(len(visual.points)), np.zeros(len(visual.points))
    for k in range(3):
        np.add.at(total, visual.faces[:, k], density * weight)
        np.add.at(weights, visual.faces[:, k], weight)
    return total / np.maximum(weights, 1.0e-24)
