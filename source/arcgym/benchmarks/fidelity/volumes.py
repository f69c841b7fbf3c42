# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Volumes of the wall's elements in a deformed state."""

from __future__ import annotations

from typing import Any

import numpy as np

from arcgym.anatomy.measures import tet_volumes
from arcgym.anatomy.shell import ShellMesh


def volume_ratios(sim: Any) -> tuple[float, float]:
    """Return the smallest and largest volume of a wall element, relative to its rest volume.

    A shell's triangle keeps no record of its thickness; in plane stress it changes by the strain
    E33 = -nu / (1 - nu) (E11 + E22), and the volume by the area's ratio times sqrt(1 + 2 E33).
    """
    wall, points = sim.colon.wall, sim.colon.data.nodal_pos_w[0].cpu().numpy().astype(float)
    if isinstance(wall, ShellMesh):
        ratio = shell_volume_ratio(wall.points, points, wall.triangles, sim.colon.elasticity()[1])
    else:
        ratio = tet_volumes(points, wall.tets) / tet_volumes(wall.points.astype(float), wall.tets)
    return float(ratio.min()), float(ratio.max())


def shell_volume_ratio(rest: np.ndarray, now: np.ndarray, triangles: np.ndarray, poissons_ratio: float) -> np.ndarray:
    """Return the volume of a shell's triangles relative to their rest volume, shape (F,).

    Args:
        rest: Vertices at rest [m], shape (V, 3).
        now: Vertices [m], shape (V, 3).
        triangles: Vertices of each triangle, shape (F, 3).
        poissons_ratio: Poisson's ratio.
    """
    metric = []
    for points in (rest.astype(float), now):
        corners = points[triangles]
        edges = corners[:, 1:] - corners[:, :1]
        metric.append(np.einsum("fai,fbi->fab", edges, edges))
    stretch = np.linalg.solve(metric[0], metric[1])  # similar to F^T F
    trace = 0.5 * (np.trace(stretch, axis1=1, axis2=2) - 2.0)
    thickness = 1.0 - 2.0 * poissons_ratio / (1.0 - poissons_ratio) * trace
    return np.sqrt(np.linalg.det(stretch) * np.maximum(thickness, 0.0))
