# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The lumen of a generated colon as a field in space, positive inside, which bends of any radius leave whole.

A point belongs to the nearest place of the centerline; the field is the lumen's radius there, folds included, less the
distance. Where the colon turns back on itself a wall is kept between its two legs.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import find_objects, gaussian_filter, label
from scipy.spatial import cKDTree

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.generator.surface import Surface

VOXEL = 0.0016
"""Edge of a voxel [m]; the surface is moved onto the exact field afterwards."""

LEAD = 0.020
"""Length by which the anal canal is continued outwards, so that the surface does not end at the verge [m]."""

_BAND = -0.005, 0.014
"""Distances out of and into the plain tube between which the field is evaluated: haustra and folds reach less [m]."""

_BLOCK = 4
"""Voxels of an edge of the blocks in which the band is looked for."""

_AT_ONCE = 400_000
"""Points evaluated at once, which bounds the memory."""

_CURVE_STEP = 0.0005
"""Distance of the centerline points to which distances are taken [m]."""

_CHUNK = 0.020
"""Length of the pieces of the centerline among which other legs are looked for [m]."""

_LEGS = 1.0, 2.0
"""Way along the centerline between two places, over the sum of their radii, from and at which they are two legs."""

_OPEN = 0.010
"""How far two places overlap before the wall between them begins, where they are not yet two legs [m]."""

_FAR_LEG = 0.022
"""Way beyond another leg's reach from which on it cannot cut into a wall [m]: folds stand out less."""

_NEAR_WALL = -0.005, 0.010
"""Distances out of and into the plain tube between which another leg may cut into it [m]."""

_CREASE = 0.45, 0.85
"""Curvature times distance towards the center of a bend where a crease begins, and where it is fully rounded."""

_ROUNDING = 0.0032
"""Standard deviation of the smoothing of creases on the inside of bends [m]: two walls do not fold to an edge."""


_BOX = 8
"""Voxels of an edge of the blocks by which creases are gathered to boxes."""


@dataclass(frozen=True)
class FieldGrid:
    """A field at the centers of voxels."""

    values: np.ndarray
    """Positive in the lumen [m], shape (X, Y, Z), float32."""
    origin: np.ndarray
    """Center of the first voxel [m], shape (3,)."""
    spacing: float
    """Edge of a voxel [m]."""


class LumenField:
    """Field of a generated lumen, at any points and on a grid."""

    def __init__(self, surface: Surface, septum: float) -> None:
        """Prepare distances to the centerline.

        Args:
            surface: Radius by arc length and angle.
            septum: Least distance of the lumens of two legs [m].
        """
        self._surface, self._septum = surface, septum
        curve = surface.curve
        self._s = np.arange(-LEAD, curve.length, _CURVE_STEP)
        tangent = curve.frame(np.array(0.0))[0]
        self._line = curve.position(self._s) + np.minimum(self._s, 0.0)[:, None] * tangent
        self._tangent = np.gradient(self._line, axis=0)
        self._tangent /= np.linalg.norm(self._tangent, axis=1, keepdims=True)
        self._bend = np.gradient(self._tangent, _CURVE_STEP, axis=0)
        self._radius = surface.lumen_radius(self._s)
        if surface.spec.closed_cecum:
            self._radius *= surface.dome(self._s)
        self._tree = cKDTree(self._line)
        self._chunks = _Chunks(self._line, self._s, self._radius, septum)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return the field at points [m], shape (n,), of positions (n, 3), without the rounding of creases."""
        return self._evaluate(points)[0]

    def places(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return arc length [m] and angle about the centerline [rad] of points, shape (n,) each, of (n, 3)."""
        s, offset = self._foot(points, self._tree.query(points)[1])
        _, normal, binormal = self._surface.curve.frame(s)
        angle = np.arctan2(np.einsum("ij,ij->i", offset, binormal), np.einsum("ij,ij->i", offset, normal))
        return s, np.mod(angle, 2 * np.pi)

    def _foot(self, points: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the arc length of the centerline's foot point near a sample, and the way from it to each point."""
        offset, tangent = points - self._line[near], self._tangent[near]
        ahead = np.einsum("ij,ij->i", offset, tangent)
        reach = 0.5 * _CURVE_STEP
        ahead = np.clip(ahead / np.maximum(1.0 - np.einsum("ij,ij->i", offset, self._bend[near]), 0.2), -reach, reach)
        s = np.clip(self._s[near] + ahead, 0.0, self._surface.curve.length)
        return s, offset - ahead[:, None] * tangent

    def sample(self, spacing: float = VOXEL) -> FieldGrid:
        """Return the field on a grid; away from the wall it is that of the plain tube, or the bounds of the band."""
        reach = float(self._radius.max()) - _BAND[0] + _BLOCK * spacing
        origin = self._line.min(0) - reach
        blocks = np.ceil((self._line.max(0) + reach - origin) / (_BLOCK * spacing)).astype(int)
        values, band = self._blocks(origin, blocks, spacing)
        crease = np.zeros(values.size, np.float32)
        for part in np.array_split(band, max(1, len(band) // _AT_ONCE)):
            at = origin + spacing * np.stack(np.unravel_index(part, values.shape), 1)
            values.ravel()[part], crease[part] = self._evaluate(at)
        return FieldGrid(_rounded(values, crease.reshape(values.shape), spacing), origin, spacing)

    def _blocks(self, origin: np.ndarray, blocks: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
        """Return a field that is right in sign outside of the band, and the voxels of blocks that meet the band."""
        edge = _BLOCK * spacing
        index = np.stack(np.meshgrid(*map(np.arange, blocks), indexing="ij"), -1).reshape(-1, 3)
        half = 0.5 * np.sqrt(3.0) * (edge - spacing)
        farthest = float(self._radius.max()) - _BAND[0] + half
        distance, near = self._tree.query(
            origin + edge * index + 0.5 * (edge - spacing), distance_upper_bound=farthest, workers=_threads()
        )
        plain = np.r_[self._radius, 0.0][near] - distance
        meets = (plain > _BAND[0] - half) & (plain < _BAND[1] + half)
        coarse = np.where(plain > 0.0, _BAND[1], _BAND[0]).astype(np.float32).reshape(blocks)
        for axis in range(3):
            coarse = np.repeat(coarse, _BLOCK, axis)
        corner = _BLOCK * index[meets]
        within = np.stack(np.meshgrid(*[np.arange(_BLOCK)] * 3, indexing="ij"), -1).reshape(-1, 3)
        voxels = (corner[:, None] + within).reshape(-1, 3)
        return np.ascontiguousarray(coarse), np.ravel_multi_index(voxels.T, coarse.shape)

    def _evaluate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the field, and how far each point is on the inside of a bend where its crease is rounded (0 to 1)."""
        distance, near = self._tree.query(points, workers=_threads())
        plain = self._radius[near] - distance
        value, crease = plain.copy(), np.zeros(len(points))
        band = np.flatnonzero((plain > _BAND[0]) & (plain < _BAND[1]))
        value[band], crease[band] = self._detailed(points[band], distance[band], near[band])
        other = self._chunks.other_leg(points, near, plain)
        return np.minimum(value, 0.5 * (np.maximum(value, plain) - other)), crease

    def _detailed(self, points: np.ndarray, distance: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the field with folds, and the marks of creases, both of shape (n,)."""
        curve = self._surface.curve
        s, offset = self._foot(points, near)
        _, normal, binormal = curve.frame(s)
        angle = np.arctan2(np.einsum("ij,ij->i", offset, binormal), np.einsum("ij,ij->i", offset, normal))
        bend = np.einsum("ij,ij->i", curve.interpolate(s, curve.curvature_vector), offset)
        crease = smooth_step(*_CREASE, bend)
        return self._surface.radius(s, np.mod(angle, 2 * np.pi), crease=crease) - distance, crease


def _threads() -> int:
    """Return how many threads look for places: one where each core has a process of its own."""
    return 1 if os.environ.get("OMP_NUM_THREADS") == "1" else 2


class _Chunks:
    """Pieces of the centerline, by which the other leg at a point is found."""

    def __init__(self, line: np.ndarray, s: np.ndarray, radius: np.ndarray, septum: float) -> None:
        self._line, self._s, self._radius, self._septum = line, s, radius, septum
        count = max(1, round((s[-1] - s[0]) / _CHUNK))
        self._bounds = np.linspace(0, len(s), count + 1).astype(int)
        self._chunk = np.repeat(np.arange(count), np.diff(self._bounds))
        self._trees = [cKDTree(line[a:b]) for a, b in zip(self._bounds[:-1], self._bounds[1:], strict=True)]
        middle = np.array([line[a:b].mean(0) for a, b in zip(self._bounds[:-1], self._bounds[1:], strict=True)])
        size = 0.5 * _CHUNK + np.array(
            [radius[a:b].max() for a, b in zip(self._bounds[:-1], self._bounds[1:], strict=True)]
        )
        self._middle, self._reach = middle, size + septum + _FAR_LEG
        gap = np.linalg.norm(middle[:, None] - middle[None], axis=2) - size[:, None] - size[None]
        apart = (
            np.abs(np.subtract.outer(np.arange(count), np.arange(count))) * _CHUNK > size[:, None] + size[None] - _CHUNK
        )
        self._near = [np.flatnonzero(row) for row in (gap < septum + 0.012) & apart]

    def other_leg(self, points: np.ndarray, near: np.ndarray, plain: np.ndarray) -> np.ndarray:
        """Return the plain field of the other leg plus the wall's thickness, largest over all legs, shape (n,)."""
        out = np.full(len(points), -1.0)
        chunk = self._chunk[near]
        order = np.argsort(chunk, kind="stable")
        first = np.searchsorted(chunk[order], np.arange(len(self._near) + 1))
        for a, others in enumerate(self._near):
            here = order[first[a] : first[a + 1]]
            if not len(others) or not len(here):
                continue
            wall = here[(plain[here] > _NEAR_WALL[0]) & (plain[here] < _NEAR_WALL[1])]
            for b in others:
                here = wall[((points[wall] - self._middle[b]) ** 2).sum(1) < self._reach[b] ** 2]
                distance, index = self._trees[b].query(points[here], distance_upper_bound=0.08)
                index = np.minimum(index, self._bounds[b + 1] - self._bounds[b] - 1) + self._bounds[b]
                ways = np.abs(self._s[index] - self._s[near[here]]) / (self._radius[index] + self._radius[near[here]])
                leg = smooth_step(*_LEGS, ways)
                value = self._radius[index] - distance + leg * (self._septum + _OPEN) - _OPEN
                out[here] = np.maximum(out[here], np.where(ways > _LEGS[0], value, -1.0))
        return out


def _rounded(values: np.ndarray, crease: np.ndarray, spacing: float) -> np.ndarray:
    """Smooth a field where creases are: in boxes round them, which are a small part of the grid."""
    sigma = _ROUNDING / spacing
    reach, out = int(4.0 * sigma + 0.5), values.copy()  # of the filter
    for box in _boxes(crease > 0.0, reach):
        around = tuple(slice(max(0, side.start - reach), side.stop + reach) for side in box)
        within = tuple(
            slice(side.start - wide.start, side.stop - wide.start) for side, wide in zip(box, around, strict=True)
        )
        soft = gaussian_filter(values[around], sigma)[within]
        share = np.clip(1.5 * gaussian_filter(crease[around], sigma)[within], 0.0, 1.0)
        out[box] = values[box] + share * (soft - values[box])
    return out


def _boxes(mark: np.ndarray, margin: int) -> list[tuple[slice, ...]]:
    """Return boxes that hold all marked voxels and what is within some voxels of them."""
    places = np.stack(np.nonzero(mark), 1)
    coarse = np.zeros([1 + size // _BOX for size in mark.shape], bool)
    coarse[tuple((places // _BOX).T)] = True
    part = label(coarse, np.ones((3, 3, 3)))[0]
    shape = np.array(mark.shape)
    boxes = []
    for box in find_objects(part):
        low = np.array([side.start for side in box]) * _BOX - margin
        high = np.array([side.stop for side in box]) * _BOX + margin
        boxes.append(tuple(map(slice, np.maximum(low, 0).tolist(), np.minimum(high, shape).tolist())))
    return boxes
