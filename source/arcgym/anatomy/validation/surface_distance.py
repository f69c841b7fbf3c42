# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far surfaces are from each other: a stage's from the lumen that it was made of."""

from __future__ import annotations

import numpy as np


def surface_samples(points: np.ndarray, faces: np.ndarray, count: int, seed: int = 0) -> np.ndarray:
    """Return random points spread evenly over a surface.

    Args:
        points: Vertices [m], shape (n, 3).
        faces: Triangles, shape (F, 3).
        count: Number of samples.
        seed: Seed of the samples.

    Returns:
        Positions [m], shape (count, 3).
    """
    a, b, c = (points[faces[:, k]].astype(float) for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    rng = np.random.default_rng(seed)
    face = rng.choice(len(faces), count, p=area / area.sum())
    u, v = rng.uniform(size=(2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[face] + u * (b[face] - a[face]) + v * (c[face] - a[face])


def distance_to_surface(queries: np.ndarray, points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the distance of positions to the nearest triangle of a surface.

    Args:
        queries: Positions [m], shape (m, 3).
        points: Vertices of the surface [m], shape (n, 3).
        faces: Its triangles, shape (F, 3).

    Returns:
        Distances [m], shape (m,).
    """
    from arcgym.utils import warp_setup  # noqa: F401  isort: skip
    import warp as wp

    from arcgym.anatomy.validation.distance_kernels import distances

    vertices = wp.array(points, dtype=wp.vec3, device="cpu")
    mesh = wp.Mesh(vertices, wp.array(faces.ravel().astype(np.int32), dtype=int, device="cpu"))
    places = wp.array(queries, dtype=wp.vec3, device="cpu")
    out = wp.zeros(len(queries), dtype=float, device="cpu")
    wp.launch(distances, len(queries), inputs=[mesh.id, places], outputs=[out], device="cpu")
    return out.numpy().astype(float)
