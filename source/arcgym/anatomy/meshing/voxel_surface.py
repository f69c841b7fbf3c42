# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The surface of a lumen on voxels as one tube: walls put between loops that touch, then smoothed and cut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from arcgym.anatomy.meshing.triangle_surface import TriangleSurface, cut_surface
from arcgym.anatomy.polyline import arc_lengths, resample

_SMOOTHING = 0.6
"""Standard deviation of the smoothing of the lumen, in voxels: a wall of one voxel stays."""

_LEAST_WAY = 0.060
"""Way along the centerline between two neighboring voxels above which there should be a wall between them [m]."""

_TURNS = 6.0
"""The same, in radii of the lumen: a bend brings places nearer than that to each other."""

_UNREACHED = 1e6
"""Arc length of voxels that no way leads to [m]; they touch no others."""

_MOVES = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) > (0, 0, 0)])
"""Steps to half of the neighbors of a voxel; the others are their opposites."""


@dataclass(frozen=True)
class Window:
    """An opening between two loops that was closed."""

    position: np.ndarray
    """Its middle [m], shape (3,)."""
    arcs: tuple[float, float]
    """Arc lengths along the centerline of the two loops there [m]."""
    area: float
    """Area of the wall that was put in [m^2]."""


@dataclass(frozen=True)
class VoxelSurface:
    """Surface of a lumen as one tube."""

    surface: TriangleSurface
    """The surface."""
    windows: list[Window]
    """Openings between loops that were closed, the largest first."""
    lost: float
    """Volume that the walls cut off from the tube and that was left out [m^3]."""


@dataclass(frozen=True)
class SeparatedLoops:
    """A lumen on voxels with walls between loops that touch."""

    lumen: np.ndarray
    """Whether each voxel is lumen, the piece with the centerline only, shape (X, Y, Z), bool."""
    windows: list[Window]
    """Openings between loops that were closed, the largest first."""
    lost: float
    """Volume that the walls cut off from the tube and that was left out [m^3]."""


def voxel_surface(values: np.ndarray, origin: np.ndarray, spacing: float, line: np.ndarray) -> VoxelSurface:
    """Return the surface of a lumen, with walls between loops that touch.

    Args:
        values: Share of each voxel that is lumen, above 0.5 inside, shape (X, Y, Z).
        origin: Center of the first voxel [m], shape (3,).
        spacing: Edge of a voxel [m].
        line: Centerline from anal verge to cecal pole, inside of the lumen [m], shape (n, 3).

    Raises:
        ValueError: The centerline is not inside of the lumen, or the walls cut it.
    """
    separated = separate_loops(values, origin, spacing, line)
    return VoxelSurface(smooth_surface(separated.lumen, origin, spacing), separated.windows, separated.lost)


def smooth_surface(mask: np.ndarray, origin: np.ndarray, spacing: float) -> TriangleSurface:
    """Return the surface of a lumen whose loops have walls between them, smoothed so little that these stay.

    Args:
        mask: Whether each voxel is lumen, shape (X, Y, Z), bool.
        origin: Center of the first voxel [m], shape (3,).
        spacing: Edge of a voxel [m].
    """
    low, kept = _boxed(mask)
    soft = ndimage.gaussian_filter(np.pad(kept, 2).astype(np.float32), _SMOOTHING)
    return cut_surface(soft, np.asarray(origin, float) + spacing * (low - 2), spacing, 0.5)


def separate_loops(values: np.ndarray, origin: np.ndarray, spacing: float, line: np.ndarray) -> SeparatedLoops:
    """Put walls between loops that touch.

    Every voxel belongs to the place of the centerline that is nearest to it on a way through the lumen. Where voxels
    that touch belong to places far from each other along the colon, two loops are open to each other, or were
    segmented as one: the voxels on both sides become wall.

    Args:
        values: Share of each voxel that is lumen, above 0.5 inside, shape (X, Y, Z).
        origin: Center of the first voxel [m], shape (3,).
        spacing: Edge of a voxel [m].
        line: Centerline from anal verge to cecal pole, inside of the lumen [m], shape (n, 3).

    Raises:
        ValueError: The centerline is not inside of the lumen, or the walls cut it.
    """
    low, mask = _boxed(values > 0.5)
    origin = np.asarray(origin, float) + spacing * low
    fine = resample(line, 0.5 * spacing)
    voxels = np.rint((fine - origin) / spacing).astype(int)
    inside = ((voxels >= 0) & (voxels < mask.shape)).all(1)
    inside[inside] = mask[tuple(voxels[inside].T)]
    if inside.mean() < 0.9:
        raise ValueError(
            f"{100 * (1 - inside.mean()):.0f} % of the centerline is outside of the lumen; expected less than 10 %."
            " Pass both in the same frame, in meters."
        )
    nearest = _nearest_places(mask, voxels[inside], np.flatnonzero(inside))
    arc = np.r_[arc_lengths(fine), _UNREACHED].astype(np.float32)[nearest]
    wall, windows = _walls(mask, arc, _radii(mask, voxels, inside, spacing), arc_lengths(fine), spacing, origin)
    kept = _piece_with(mask & ~wall, voxels[inside])
    lost = (mask & ~wall & ~kept).sum() * spacing**3
    whole = np.zeros(values.shape, bool)
    whole[tuple(slice(k + 1, k + size - 1) for k, size in zip(low, mask.shape, strict=True))] = kept[1:-1, 1:-1, 1:-1]
    return SeparatedLoops(whole, windows, float(lost))


def _boxed(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first index and the contents of the smallest box round a mask, with a margin of one voxel."""
    box = ndimage.find_objects(mask.astype(np.int8))
    if not box:
        raise ValueError("The lumen is empty: no voxel is above 0.5.")
    return np.array([part.start - 1 for part in box[0]]), np.pad(mask[box[0]], 1)


def _nearest_places(mask: np.ndarray, seeds: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Return the number of the seed that is nearest to each voxel on a way through the mask, -1 outside.

    Grows shell by shell over all 26 neighbors; of the seeds that reach a voxel in the same shell, the one at the least
    straight distance takes it.
    """
    owner = np.full(mask.shape, -1, np.int32)
    owner[tuple(seeds.T)] = np.arange(len(seeds))
    moves, front = np.concatenate([_MOVES, -_MOVES]), np.unique(seeds, axis=0)
    flat, strides = owner.ravel(), np.array(mask.strides) // mask.itemsize
    while len(front):
        reached = (front[:, None] + moves).reshape(-1, 3)
        source = np.repeat(owner[tuple(front.T)], len(moves))
        key = reached @ strides
        free = mask.ravel()[key] & (flat[key] < 0)
        reached, source, key = reached[free], source[free], key[free]
        distance = ((reached - seeds[source]) ** 2).sum(1)
        order = np.lexsort((distance, key))
        first = order[np.r_[True, key[order][1:] != key[order][:-1]]] if len(order) else order
        front = reached[first]
        flat[key[first]] = source[first]
    return np.where(owner < 0, -1, numbers[owner])


def _radii(mask: np.ndarray, voxels: np.ndarray, inside: np.ndarray, spacing: float) -> np.ndarray:
    """Return the distance to the wall along the centerline, smoothed over a centimeter [m], shape (n,)."""
    distance = spacing * ndimage.distance_transform_edt(mask)
    at = np.arange(len(voxels))
    radius = np.interp(at, at[inside], distance[tuple(voxels[inside].T)])
    return ndimage.gaussian_filter1d(radius, 20.0, mode="nearest")


def _walls(
    mask: np.ndarray, arc: np.ndarray, radius: np.ndarray, line_arc: np.ndarray, spacing: float, origin: np.ndarray
) -> tuple[np.ndarray, list[Window]]:
    """Return the voxels that become wall, shape of the mask, and the windows that they close."""
    wall, found = np.zeros(mask.shape, bool), []
    for move in _MOVES:
        here = tuple(slice(max(0, -m), min(n, n - m)) for m, n in zip(move, mask.shape, strict=True))
        there = tuple(slice(max(0, m), min(n, n + m)) for m, n in zip(move, mask.shape, strict=True))
        both = mask[here] & mask[there]
        ways = np.zeros(both.shape, np.float32)
        ways[both] = np.abs(arc[here][both] - arc[there][both])
        index = np.argwhere(ways > _LEAST_WAY)
        a, b = index + [part.start for part in here], index + [part.start for part in there]
        arcs = np.stack([arc[tuple(a.T)], arc[tuple(b.T)]], 1)
        far = np.abs(np.diff(arcs, axis=1)[:, 0]) > _TURNS * np.interp(arcs, line_arc, radius).max(1)
        wall[tuple(a[far].T)] = wall[tuple(b[far].T)] = True
        found.append(np.concatenate([a[far], np.sort(arcs[far], axis=1)], 1))
    return wall, _windows(wall, np.concatenate(found), spacing, origin)


def _windows(wall: np.ndarray, pairs: np.ndarray, spacing: float, origin: np.ndarray) -> list[Window]:
    """Group the pairs of voxels with a wall between them into windows."""
    label, count = ndimage.label(ndimage.binary_dilation(wall, iterations=2))
    number = label[tuple(pairs[:, :3].astype(int).T)]
    windows = []
    for k in range(1, count + 1):
        own, voxels = pairs[number == k], ((label == k) & wall).sum()
        if len(own):
            first, second = np.median(own[:, 3:], axis=0)
            middle = origin + spacing * own[:, :3].mean(0)
            windows.append(Window(middle, (float(first), float(second)), float(0.5 * voxels * spacing**2)))
    return sorted(windows, key=lambda window: -window.area)


def _piece_with(mask: np.ndarray, voxels: np.ndarray) -> np.ndarray:
    """Return the connected piece of a mask that holds the centerline, from its beginning to its end."""
    label, _ = ndimage.label(mask)
    along = label[tuple(voxels.T)]
    along = along[along > 0]
    piece = int(np.bincount(along).argmax()) if len(along) else 0
    here = np.flatnonzero(along == piece)
    if not piece or len(here) < 0.95 * len(along):
        raise ValueError(
            f"The walls between touching loops cut the lumen: {len(here)} of {len(along)} voxels of the centerline are"
            " in one piece. Take the loops apart in the segmentation."
        )
    return label == piece
