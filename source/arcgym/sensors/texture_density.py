# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Density of a texture on a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh


def texel_density(visual: VisualMesh, width: int, height: int) -> np.ndarray:
    """Return the texels per meter at every vertex along the texture's denser axis, shape (M,), float64.

    The renderer picks the level of the texture pyramid by it. It is taken at rest, as the mean over the triangles
    around a vertex, so that levels change smoothly over the surface.
    """
    corner = visual.points[visual.faces].astype(np.float64)
    uv = visual.uv[visual.faces].astype(np.float64) * (width, height)
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = np.cross(e1, e2)
    area_sq = np.maximum((area**2).sum(axis=1), 1.0e-24)
    gradient = np.cross(d1[:, :, None] * e2[:, None] - d2[:, :, None] * e1[:, None], area[:, None])
    density = np.linalg.norm(gradient, axis=2).max(axis=1) / area_sq
    return _vertex_mean(visual, density, np.sqrt(area_sq))


def _vertex_mean(visual: VisualMesh, value: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the weighted mean over the triangles around each vertex of a value per triangle."""
    total, weights = np.zeros(len(visual.points)), np.zeros(len(visual.points))
    for k in range(3):
        np.add.at(total, visual.faces[:, k], value * weight)
        np.add.at(weights, visual.faces[:, k], weight)
    return total / np.maximum(weights, 1.0e-24)
