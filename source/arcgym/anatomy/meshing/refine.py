# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Conforming red-green refinement of a triangle mesh in parameter space."""

from __future__ import annotations

import numpy as np

from arcgym.anatomy.meshing.triangle_surface import edge_ends, edge_keys


def refine(points: np.ndarray, faces: np.ndarray, selected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split the selected triangles into four and their neighbors as far as needed to leave no hanging vertex.

    Args:
        points: Coordinates, shape (n, k).
        faces: Triangles, shape (F, 3).
        selected: Which triangles to split, shape (F,), bool.

    Returns:
        The refined points and faces; old points keep their numbers and every winding is kept.
    """
    keys, inverse = np.unique(edge_keys(faces, len(points)).T.ravel(), return_inverse=True)
    edge_of = inverse.reshape(3, -1).T
    split = _close(edge_of, selected, len(keys))
    middle = np.full(len(keys), -1)
    middle[split] = len(points) + np.arange(split.sum())
    ends = edge_ends(keys[split], len(points))
    points = np.concatenate([points, 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])])
    cuts = split[edge_of].sum(1)
    parts = [faces[cuts == 0], _split_in_four(faces[cuts == 3], middle[edge_of[cuts == 3]])]
    parts += _split_in_two(faces[cuts == 1], middle[edge_of[cuts == 1]])
    return points, np.concatenate(parts).astype(np.int32)


def _close(edge_of: np.ndarray, selected: np.ndarray, count: int) -> np.ndarray:
    """Mark the edges to split until no triangle has exactly two of them, shape (count,), bool."""
    split = np.zeros(count, bool)
    split[edge_of[selected].ravel()] = True
    while (two := split[edge_of].sum(1) == 2).any():
        split[edge_of[two].ravel()] = True
    return split


def _split_in_four(faces: np.ndarray, middle: np.ndarray) -> np.ndarray:
    (a, b, c), (ab, bc, ca) = faces.T, middle.T
    corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(corner, 1) for corner in corners])


def _split_in_two(faces: np.ndarray, middle: np.ndarray) -> list[np.ndarray]:
    parts = []
    for k in range(3):
        cut = middle[:, k] >= 0
        a, b, c = (faces[cut, (k + i) % 3] for i in range(3))
        new = middle[cut, k]
        parts += [np.stack([a, new, c], 1), np.stack([new, b, c], 1)]
    return parts
