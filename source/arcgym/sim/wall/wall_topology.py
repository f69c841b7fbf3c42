# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Connectivity of one world's wall, in numpy: lumen faces sorted along the centerline, tets around each vertex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PATCH_FACES = 6
"""Faces of a patch: a quarter of a ring of twelve vertices. The contact search looks at whole patches first."""


@dataclass(frozen=True)
class LumenTopology:
    """Faces of the lumen side, sorted by ring (the lowest ring of their vertices)."""

    rings: np.ndarray
    """Inner vertices of each ring, padded with the ring's first, shape (R, S), int32."""
    faces: np.ndarray
    """Vertices, wound so that normals point into the wall, shape (F, 3), int32."""
    neighbors: np.ndarray
    """Face across the edge opposite to each corner, or -1, shape (F, 3), int32."""
    ring_start: np.ndarray
    """First face of each ring, shape (R + 1,), int32."""
    patch_start: np.ndarray
    """First face of each patch, some neighboring faces of one ring, shape (P + 1,), int32."""
    ring_patch: np.ndarray
    """First patch of each ring, shape (R + 1,), int32."""
    patch_vertices: np.ndarray
    """Vertices of each patch, padded with its first, shape (P, K), int32."""


def lumen_topology(points: np.ndarray, faces: np.ndarray, ring: np.ndarray, layer: np.ndarray) -> LumenTopology:
    """Sort the lumen faces by ring and connect them.

    Args:
        points: Rest positions [m], shape (V, 3).
        faces: Faces of the lumen side, normals into the wall, shape (F, 3).
        ring: Ring of each wall vertex, shape (V,).
        layer: Layer of each wall vertex, 0 = inner, shape (V,).
    """
    lowest = ring[faces].min(axis=1)
    count = int(ring.max()) + 1
    rings = members(np.where(layer == 0)[0], ring, count, pad_first=True)
    sector = _sectors(ring, layer)
    if sector is None:
        angle = _angle_around(points[faces].mean(axis=1) - points[rings].mean(axis=1)[lowest], lowest)
    else:
        angle = np.angle(np.exp(2j * np.pi * sector[faces]).sum(axis=1))
    order = np.lexsort((angle, lowest))
    faces = faces[order].astype(np.int32)
    ring_start = np.searchsorted(lowest[order], np.arange(count + 1)).astype(np.int32)
    patch_start, ring_patch = patches(ring_start)
    vertices = patch_vertices(faces, patch_start)
    return LumenTopology(rings, faces, face_neighbors(faces), ring_start, patch_start, ring_patch, vertices)


def _sectors(ring: np.ndarray, layer: np.ndarray) -> np.ndarray | None:
    """Return how far around its ring each vertex of the lumen side is, 0 to 1, shape (V,); None without a grid.

    On a grid of rings and sectors the order of the faces is that of their numbers: the same in every patient.
    """
    inner = np.flatnonzero(layer == 0)
    rings = int(ring.max()) + 1
    count = len(inner) // rings
    if not np.array_equal(ring[inner], np.repeat(np.arange(rings), count)):
        return None
    sector = np.zeros(len(ring))
    sector[inner] = np.tile(np.arange(count) / count, rings)
    return sector


def _angle_around(arm: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Angle of each face around its ring, in the plane in which the ring's faces spread most.

    Args:
        arm: From the ring's center to the face [m], shape (F, 3).
        ring: Ring of each face, shape (F,).

    Returns:
        [rad], shape (F,).
    """
    angle = np.zeros(len(arm))
    for r in np.unique(ring):
        here = ring == r
        axes = np.linalg.svd(arm[here], full_matrices=False)[2]
        angle[here] = np.arctan2(arm[here] @ axes[1 % len(axes)], arm[here] @ axes[0])
    return angle


def patches(ring_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split the faces of each ring into patches; first face of each patch and first patch of each ring."""
    starts = [
        np.arange(a, b, PATCH_FACES, dtype=np.int32) for a, b in zip(ring_start[:-1], ring_start[1:], strict=True)
    ]
    ring_patch = np.cumsum([0, *map(len, starts)]).astype(np.int32)
    return np.append(np.concatenate(starts), ring_start[-1]).astype(np.int32), ring_patch


def patch_vertices(faces: np.ndarray, patch_start: np.ndarray) -> np.ndarray:
    """Return the vertices of each patch of ``faces``, each once, padded with the first, shape (P, K), int32."""
    groups = [np.unique(faces[a:b]) for a, b in zip(patch_start[:-1], patch_start[1:], strict=True)]
    out = np.zeros((len(groups), max(map(len, groups))), np.int32)
    for row, group in zip(out, groups, strict=True):
        row[:] = group[0]
        row[: len(group)] = group
    return out


def members(vertices: np.ndarray, ring: np.ndarray, count: int, pad_first: bool) -> np.ndarray:
    """Return the vertices of each ring as a rectangular array, padded with the ring's first vertex or with -1.

    Raises:
        ValueError: If a ring has no vertices.
    """
    groups = [vertices[ring[vertices] == r] for r in range(count)]
    empty = [r for r, group in enumerate(groups) if len(group) == 0]
    if empty:
        raise ValueError(f"Wall rings {empty[:5]} have no vertices; every ring from 0 to {count - 1} needs some.")
    out = np.full((count, max(map(len, groups))), -1, np.int32)
    for r, group in enumerate(groups):
        out[r, : len(group)] = group
        if pad_first:
            out[r, len(group) :] = group[0]
    return out


def ring_mean(values: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Return the mean over each ring's vertices of ``values``, shape (V, ...), with ``ring`` (V,); shape (R, ...)."""
    out = np.zeros((int(ring.max()) + 1, *values.shape[1:]))
    np.add.at(out, ring, values)
    return out / np.bincount(ring).reshape(-1, *[1] * (values.ndim - 1))


def face_neighbors(faces: np.ndarray) -> np.ndarray:
    """Return the face across the edge opposite to each corner, or -1 at a border, shape (F, 3), int32."""
    edges = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2).reshape(-1, 2)
    key = edges[:, 0].astype(np.int64) * (int(faces.max()) + 1) + edges[:, 1]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    a, b = order[same], order[same + 1]
    out = np.full(3 * len(faces), -1, np.int32)
    out[a], out[b] = b // 3, a // 3
    return out.reshape(-1, 3)


def vertex_entries(elements: np.ndarray, vertices: int) -> tuple[np.ndarray, np.ndarray]:
    """List the elements of n corners around each vertex.

    Returns:
        First entry of each vertex, shape (V + 1,), and the entries n * element + corner, shape (n*E,).
    """
    flat = elements.ravel()
    entry = np.argsort(flat, kind="stable").astype(np.int32)
    start = np.searchsorted(flat[entry], np.arange(vertices + 1)).astype(np.int32)
    return start, entry
