# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Openings of a surface: at the rectum, and perhaps at the cecum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

_SMALLEST, _LARGEST = 0.004, 0.080
"""Range of an opening's radius [m]."""

_NEAR = 2.5
"""Largest distance of a path from the opening it leads to, in the opening's radii."""

_SPACING = 0.003
"""Distance of the points that lead to the middle [m]."""


@dataclass(frozen=True)
class Opening:
    """A hole of a surface, as wide as a lumen."""

    center: np.ndarray
    """Middle of its rim [m], shape (3,)."""
    radius: float
    """Length of its rim over two pi [m]."""

    def turned(self, rotation: np.ndarray) -> Opening:
        """Return the opening on other axes."""
        return replace(self, center=rotation @ self.center)


def find_openings(points: np.ndarray, faces: np.ndarray) -> list[Opening]:
    """Find the holes of a surface.

    Args:
        points: Vertices [m]; those in the same place are taken for one, shape (n, 3).
        faces: Triangles, shape (m, 3).
    """
    places, index = np.unique(points, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(edges[edges[:, 0] < edges[:, 1]], axis=0, return_counts=True)
    rim = edges[uses == 1]
    joined = coo_array((np.ones(len(rim)), rim.T), shape=(len(places), len(places)))
    loop = connected_components(joined, directed=False)[1][rim[:, 0]]
    length = np.linalg.norm(places[rim[:, 0]] - places[rim[:, 1]], axis=1)
    middle = places[rim].mean(1)
    found = []
    for name in np.unique(loop):
        here = loop == name
        radius = float(length[here].sum()) / (2 * np.pi)
        if _SMALLEST < radius < _LARGEST:
            found.append(Opening((length[here] @ middle[here]) / length[here].sum(), radius))
    return found


def lead_to_opening(path: np.ndarray, openings: Sequence[Opening]) -> np.ndarray | None:
    """Lead the end of a path to the middle of the opening there, whichever way that was cut.

    Args:
        path: Path to the end, evenly spaced [m], shape (n, 3).
        openings: Where the surface is open.

    Returns:
        The path, or None where no opening is near its end.
    """
    for opening in openings:
        distance = np.linalg.norm(path - opening.center, axis=1)
        nearest = int(distance.argmin())
        beyond = float(np.linalg.norm(np.diff(path[nearest:], axis=0), axis=1).sum())
        if distance[nearest] > _NEAR * opening.radius or beyond > _NEAR * opening.radius:
            continue
        outside = np.flatnonzero(distance[: nearest + 1] > opening.radius)
        if len(outside):
            kept = path[: outside[-1] + 1]
            share = np.linspace(0.0, 1.0, max(2, round(distance[outside[-1]] / _SPACING) + 1))[1:, None]
            return np.concatenate([kept, kept[-1] + share * (opening.center - kept[-1])])
    return None
