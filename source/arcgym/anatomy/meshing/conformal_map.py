# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A conformal map of a lumen's surface: u runs from one end to the other, v once round.

u is harmonic on the surface, 0 on a cap round one end and 1 on a cap round the other; v is its conjugate, which jumps
by a full turn across a path from cap to cap. Both by the cotangent Laplacian (Pinkall and Polthier, 1993). Level curves
of u never cross, however the lumen bends, and curves of equal v cut them at right angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import splu

from arcgym.anatomy.meshing.triangle_surface import TriangleSurface, connected_parts, edge_ends, edge_keys

CAP_RADIUS = 0.006
"""Distance from an end within which the surface is one cap [m]: less than the radius of any lumen."""

_WEIGHTS = 0.02, 20.0
"""Least and largest cotangent weight: slivers of marching cubes would spoil the system's condition, and negative
weights of obtuse angles the maximum principle."""


@dataclass(frozen=True)
class ConformalMap:
    """Coordinates u and v on the surface between two caps."""

    points: np.ndarray
    """Vertices [m], shape (n, 3)."""
    faces: np.ndarray
    """Triangles without those of the caps, shape (F, 3)."""
    u: np.ndarray
    """From 0 on the first cap to 1 on the second, shape (n,)."""
    v: np.ndarray
    """Angle round the lumen, up to full turns [rad], shape (n,)."""
    cut: np.ndarray
    """Vertices of a path along the surface from cap to cap, shape (m,)."""


def map_surface(surface: TriangleSurface, first: np.ndarray, last: np.ndarray) -> ConformalMap:
    """Map a closed surface.

    Args:
        surface: Surface of the lumen.
        first: Position at or near the surface at one end [m], shape (3,).
        last: Position at or near it at the other end [m], shape (3,).

    Raises:
        ValueError: The ends are so near each other that their caps meet.
    """
    points, faces = surface.points, surface.faces
    caps = [_cap(surface, end) for end in (first, last)]
    if (caps[0] & caps[1]).any():
        gap = 1e3 * np.linalg.norm(np.asarray(first) - last)
        raise ValueError(
            f"The ends of the lumen are {gap:.1f} mm apart; caps of {1e3 * CAP_RADIUS:g} mm round them meet."
            " Pass the two ends of the lumen, in meters."
        )
    weights = _cotangent_weights(points, faces)
    u = _harmonic(_laplacian(weights, faces, len(points)), *caps)
    tube = ~(caps[0][faces].all(1) | caps[1][faces].all(1))
    faces, weights = faces[tube], weights[tube]
    cut = _path(points, faces, *caps)
    v = _conjugate(weights, faces, _jumps(faces, cut), cut, len(points))
    return ConformalMap(points, faces, u, v, cut)


def _cap(surface: TriangleSurface, end: np.ndarray) -> np.ndarray:
    """Mark the vertices round an end that are connected to the one nearest to it, shape (n,), bool."""
    points = surface.points
    pole = int(np.linalg.norm(points - end, axis=1).argmin())
    near = np.linalg.norm(points - points[pole], axis=1) < CAP_RADIUS
    part = connected_parts(surface.faces[near[surface.faces].all(1)], len(points))
    return near & (part == part[pole])


def _cotangent_weights(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return half the cotangent of each corner's angle, the weight of the edge opposite to it, shape (F, 3)."""
    weights = np.empty(faces.shape)
    for k in range(3):
        corner = points[faces[:, k]]
        a, b = points[faces[:, (k + 1) % 3]] - corner, points[faces[:, (k + 2) % 3]] - corner
        area = np.linalg.norm(np.cross(a, b), axis=1)
        weights[:, k] = 0.5 * np.einsum("ij,ij->i", a, b) / np.maximum(area, 1e-18)
    return np.clip(weights, *_WEIGHTS)


def _laplacian(weights: np.ndarray, faces: np.ndarray, count: int) -> csr_array:
    """Return the symmetric, positive semidefinite Laplacian of edge weights, shape (count, count)."""
    i, j = faces[:, [1, 2, 0]].T.ravel(), faces[:, [2, 0, 1]].T.ravel()
    half = coo_array((weights.T.ravel(), (i, j)), shape=(count, count)).tocsr()
    both = (half + half.T).tocsr()
    return (diags_array(both.sum(axis=1)) - both).tocsr()


def _harmonic(laplacian: csr_array, zero: np.ndarray, one: np.ndarray) -> np.ndarray:
    """Return the harmonic function that is 0 and 1 where the two masks say, shape (n,)."""
    u, free = one.astype(float), ~(zero | one)
    rows = laplacian[np.flatnonzero(free)]
    u[free] = _solve(rows[:, np.flatnonzero(free)], -(rows @ u))
    return u


def _solve(matrix: csr_array, right: np.ndarray) -> np.ndarray:
    """Solve a symmetric, positive definite system by a sparse factorization without pivoting."""
    factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return factors.solve(right)


def _path(points: np.ndarray, faces: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return the vertices of the shortest path along edges from one cap's rim to the other's."""
    edges = edge_ends(np.unique(edge_keys(faces, len(points))), len(points))
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = coo_array((length, edges.T), shape=(len(points), len(points))).tocsr()
    used = np.zeros(len(points), bool)
    used[faces] = True
    starts, ends = np.flatnonzero(first & used), np.flatnonzero(last & used)
    distance, before, _ = dijkstra(graph, directed=False, indices=starts, return_predecessors=True, min_only=True)
    path = [int(ends[distance[ends].argmin()])]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return np.array(path[::-1])


def _jumps(faces: np.ndarray, cut: np.ndarray) -> np.ndarray:
    """Return the full turn [rad] by which v is larger at the corners on the cut's left than on its right, (F, 3)."""
    jump = np.zeros(faces.shape)
    near = np.flatnonzero(np.isin(faces, cut).any(1))
    corners = {int(t): faces[t].tolist() for t in near}
    face_of = {(c[k], c[(k + 1) % 3]): t for t, c in corners.items() for k in range(3)}
    for k, vertex in enumerate(cut.tolist()):
        before = int(cut[k - 1]) if k else -1
        if k + 1 < len(cut):
            fan = _fan(vertex, int(cut[k + 1]), before, face_of, corners, 2)
        else:
            fan = _fan(vertex, before, -1, face_of, corners, 1)
        for t in fan:
            jump[t, corners[t].index(vertex)] = 2 * np.pi
    return jump


def _fan(vertex: int, start: int, stop: int, face_of: dict, corners: dict, turn: int) -> list[int]:
    """Return the faces round a vertex from one neighbor to another: to the left for ``turn`` 2, to the right for 1."""
    fan: list[int] = []
    at = start
    while at != stop or not fan:
        edge = (vertex, at) if turn == 2 else (at, vertex)
        if edge not in face_of:
            break
        face = face_of[edge]
        fan.append(face)
        at = corners[face][(corners[face].index(vertex) + turn) % 3]
    return fan


def _conjugate(weights: np.ndarray, faces: np.ndarray, jump: np.ndarray, cut: np.ndarray, count: int) -> np.ndarray:
    """Return the function whose differences along edges, jumps added, are least squares zero, shape (n,)."""
    right = np.zeros(count)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        flow = weights[:, k] * (jump[:, i] - jump[:, j])
        right += np.bincount(faces[:, j], flow, count) - np.bincount(faces[:, i], flow, count)
    free = np.zeros(count, bool)
    free[faces] = True
    free[cut[len(cut) // 2]] = False
    index = np.flatnonzero(free)
    v = np.zeros(count)
    v[free] = _solve(_laplacian(weights, faces, count)[index][:, index], right[free])
    return v
