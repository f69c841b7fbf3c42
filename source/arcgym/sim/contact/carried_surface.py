# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fine surface that the scope touches, carried by the wall: its faces, and its points in every world."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import warp as wp

from arcgym.anatomy.stage import ContactSurface
from arcgym.sim.contact import carried_kernels as kernels
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall.wall_topology import LumenTopology, face_neighbors, patch_vertices, patches

CARRIED_SHARE = 1.0e-3
"""Weight of a vertex that other wall vertices than its cell's may have."""


class CarriedSurface:
    """A fine surface in every world: folds that the wall is too coarse for.

    Each cell of the wall, between two rings and two sectors, carries rows and columns of it: a point of the surface is
    the mean of the cell's four wall vertices by its weights, and an offset from there that turns with the cell. What
    presses on the point presses on these vertices by the same weights.
    """

    def __init__(
        self,
        surfaces: Sequence[ContactSurface],
        rest: Sequence[np.ndarray],
        wall: LumenTopology,
        patient: wp.array,
        rows_alone: bool = False,
    ):
        """Find the cell of each face and the offset of each point.

        Args:
            surfaces: Surface of each of P patients, M points; all have the same columns and carriers.
            rest: Rest positions of each patient's wall [m], shape (V, 3).
            wall: Lumen faces of a wall.
            patient: Patient of each world, shape (W,), int32.
            rows_alone: Whether to take all of their rows, but no columns between the wall's.

        Raises:
            ValueError: If the surfaces do not divide the wall's cells evenly, or differ in more than their points.
        """
        along = surfaces[0].columns // wall.rings.shape[1]
        if rows_alone:
            surfaces = [without_columns(surface, max(along, 1)) for surface in surfaces]
        first = surfaces[0]
        for surface in surfaces[1:]:
            same = np.array_equal(surface.skin_indices, first.skin_indices)
            if not same or not np.allclose(surface.skin_weights, first.skin_weights, atol=CARRIED_SHARE):
                raise ValueError(
                    f"Contact surfaces of {len(first.points)} and {len(surface.points)} points are carried by other "
                    "vertices of the wall: all patients of a run need the same grid. Set env.sim.contact.surface=wall."
                )
        device = str(patient.device)
        self.topology, self.carriers, self.weights = carried_topology(first, wall, along)
        self.patient = patient
        offsets = [local_offsets(s, points) for s, points in zip(surfaces, rest, strict=True)]
        self._offset = patient_array(offsets, wp.vec3, device)
        self.room = patient_array([longest_offsets(one, self.topology) for one in offsets], float, device)
        """Longest offset of a point of each ring [m], shape (R, P)."""
        self.near = wp.ones((len(wall.rings), len(patient)), dtype=int, device=device)
        """1 where a link may touch a ring, shape (R, W), as of the last update."""
        self._ring = wp.array(first.skin_indices.min(axis=1) // wall.rings.shape[1], dtype=int, device=device)
        self._index = wp.array(first.skin_indices, dtype=wp.vec4i, device=device)
        self._weight = wp.array(first.skin_weights, dtype=wp.vec4, device=device)
        self._moved = wp.ones_like(self.near)
        self.points = wp.zeros((len(first.points), len(patient)), dtype=wp.vec3, device=device)
        """Positions [m], shape (M, W), as of the last update."""

    def update(self, x: wp.array) -> wp.array:
        """Return the points for wall positions ``x`` [m], shape (V, W)."""
        self.near.fill_(1)
        return self.update_near(x)

    def update_near(self, x: wp.array) -> wp.array:
        """Return the points with those of the rings that are :attr:`near`, and around them, moved on."""
        device = self.points.device
        wp.launch(kernels.mark_carried_rings, self.near.shape, [self.near], [self._moved], device=device)
        inputs = [x, self._moved, self._ring, self._index, self._weight, self._offset, self.patient]
        wp.launch(kernels.carry_points, self.points.shape, inputs, [self.points], device=device)
        return self.points


def without_columns(surface: ContactSurface, step: int) -> ContactSurface:
    """Return a surface with every ``step``-th of its columns."""
    keep = np.arange(len(surface.points)).reshape(-1, surface.columns)[:, ::step]
    vertices = keep.ravel()
    points, index, weight = (part[vertices] for part in (surface.points, surface.skin_indices, surface.skin_weights))
    return ContactSurface(points, keep.shape[1], index, weight)


def carried_topology(
    surface: ContactSurface, wall: LumenTopology, along: int
) -> tuple[LumenTopology, np.ndarray, np.ndarray]:
    """Return the faces of a surface sorted by the wall's rings, and what carries them.

    Args:
        surface: The surface.
        wall: Lumen faces of the wall; its vertices are numbered ring by ring, sector by sector.
        along: Rows of the surface for each ring of the wall.

    Returns:
        The faces; the wall vertices that carry each, shape (F, 4), int32; and their weights in each corner, shape
        (F, 3, 4).

    Raises:
        ValueError: If a face is not carried by the four vertices of one cell.
    """
    rings, sectors = wall.rings.shape
    parts, columns = surface.columns // sectors, surface.columns
    faces = surface.faces()
    at = np.arange(len(faces)) % (len(faces) // 2)
    row, column = at // columns, at % columns
    keep = (faces >= (surface.rows - 1) * columns).sum(axis=1) < 2  # those at the pole have no area
    faces, row, column = faces[keep], row[keep], column[keep]
    ring, sector = np.minimum(row // max(along, 1), rings - 2), column // max(parts, 1)
    order = np.lexsort((row, column, ring))
    faces, ring, sector = faces[order].astype(np.int32), ring[order], sector[order]
    after = (sector + 1) % sectors
    low, high = ring * sectors, (ring + 1) * sectors
    carriers = np.stack([low + sector, high + sector, high + after, low + after], axis=1)
    index, weight = surface.skin_indices[faces], surface.skin_weights[faces]
    weights = (weight[..., None] * (index[..., None] == carriers[:, None, None])).sum(axis=2)
    lost = float(np.abs(weights.sum(axis=2) - 1.0).max())
    if parts * sectors != columns or lost > CARRIED_SHARE:
        raise ValueError(
            f"The contact surface has {surface.rows} rows and {columns} columns on a wall of {rings} rings and "
            f"{sectors} sectors, and a share of {lost:.2g} of a point is carried by another cell of the wall than its "
            "face's: rows and columns must divide the wall's cells evenly. Set env.sim.contact.surface=wall."
        )
    ring_start = np.searchsorted(ring, np.arange(rings + 1)).astype(np.int32)
    patch_start, ring_patch = patches(ring_start)
    vertices = patch_vertices(faces, patch_start)
    topology = LumenTopology(wall.rings, faces, face_neighbors(faces), ring_start, patch_start, ring_patch, vertices)
    return topology, carriers.astype(np.int32), weights.astype(np.float32)


def longest_offsets(offset: np.ndarray, topology: LumenTopology) -> np.ndarray:
    """Return the longest ``offset``, shape (M, 3), of the points of each ring's faces [m], shape (R,)."""
    longest = np.linalg.norm(offset, axis=1)[topology.faces].max(axis=1)
    return np.array([longest[a:b].max(initial=0.0) for a, b in pairwise(topology.ring_start)])


def local_offsets(surface: ContactSurface, rest: np.ndarray) -> np.ndarray:
    """Return the way from where the wall carries each point to the point, in its cell's frame [m], shape (M, 3).

    Args:
        surface: Surface of M points.
        rest: Rest positions of the wall [m], shape (V, 3).
    """
    corners = np.asarray(rest, dtype=float)[surface.skin_indices]
    away = surface.points - np.einsum("mk,mki->mi", surface.skin_weights.astype(float), corners)
    along = corners[:, 1] + corners[:, 2] - corners[:, 0] - corners[:, 3]
    around = corners[:, 2] + corners[:, 3] - corners[:, 0] - corners[:, 1]
    first = along / np.linalg.norm(along, axis=1, keepdims=True)
    normal = np.cross(along, around)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    frame = np.stack([first, np.cross(normal, first), normal], axis=1)
    return np.einsum("mij,mj->mi", frame, away)
