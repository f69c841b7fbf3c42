# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps the colon among the pieces of a mask: bridges short gaps along the lumen, drops everything else."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from .errors import ColonImportError
from .grid import Grid

_SMALLEST_PIECE = 5e-7
_SMALLEST_COLON = 8e-5
_LEAST_EXTENT = 0.15
_BRIDGE_RADIUS = 0.004
_END_REACH = 0.030
_THIN = 0.007


@dataclass
class Cleaning:
    """What was kept, joined and dropped."""

    pieces: int = 0
    """Separate pieces in the input."""
    specks: int = 0
    """Pieces below 0.5 ml, which are always dropped."""
    bridges: list[dict[str, float]] = field(default_factory=list)
    """Gap [mm] and volume [ml] of each piece that was joined."""
    dropped: list[dict[str, float]] = field(default_factory=list)
    """Volume [ml] of the larger pieces that were left out, with their gap to the colon [mm]."""


def keep_colon(grid: Grid, max_gap: float) -> tuple[Grid, Cleaning]:
    """Keeps the largest piece and those that continue it end to end.

    Args:
        grid: The lumen.
        max_gap: Longest collapsed or fluid-filled stretch to bridge [m].

    Returns:
        The field with other pieces set to 0 and bridges to 1, and what was done.

    Raises:
        ColonImportError: The largest piece is no colon.
    """
    labels, count = ndimage.label(grid.mask, np.ones((3, 3, 3)))
    volume = np.bincount(labels.ravel(), minlength=count + 1)[1:] * grid.spacing**3
    if not count or volume.max() < _SMALLEST_COLON:
        largest = 1e6 * volume.max(initial=0.0)
        raise ColonImportError(
            f"The largest of {count} pieces holds {largest:.1f} ml; a colon's lumen holds more than "
            f"{1e6 * _SMALLEST_COLON:.0f} ml",
            "Check --label and the units (--spacing, --units).",
        )
    done = Cleaning(pieces=count)
    pieces = [k + 1 for k in np.argsort(-volume) if volume[k] > _SMALLEST_PIECE]
    done.specks = count - len(pieces)
    boxes = ndimage.find_objects(labels)
    shells = {k: _shell(labels, boxes[k - 1], k) for k in pieces}
    kept, bridges = _join(grid, shells, volume, max_gap, done)
    _check_extent(grid, np.concatenate([shells[k] for k in kept]))
    keep = np.isin(labels, kept)
    for start, end in bridges:
        _draw_bridge(keep, start, end, _BRIDGE_RADIUS / grid.spacing)
    values = np.where(ndimage.binary_dilation(keep), grid.values, 0.0).astype(np.float32)
    values[keep] = np.maximum(values[keep], 0.51)
    holes = ndimage.binary_fill_holes(keep) & ~keep
    values[holes] = 1.0
    return Grid(values, grid.origin, grid.spacing), done


def _shell(labels: np.ndarray, box: tuple[slice, ...], k: int) -> np.ndarray:
    """Returns the boundary voxels of a piece, shape (n, 3)."""
    piece = np.pad(labels[box] == k, 1)
    border = (piece & ~ndimage.binary_erosion(piece))[1:-1, 1:-1, 1:-1]
    return np.argwhere(border) + [s.start for s in box]


def _join(
    grid: Grid, shells: dict[int, np.ndarray], volume: np.ndarray, max_gap: float, done: Cleaning
) -> tuple[list[int], list[tuple[np.ndarray, np.ndarray]]]:
    """Attaches pieces to the largest one, nearest first, where end meets end."""
    names = list(shells)
    kept, waiting, bridges = [names[0]], set(names[1:]), []
    gaps: dict[int, tuple[float, np.ndarray, np.ndarray]] = {}
    newest: int | None = names[0]
    while waiting and newest is not None:
        tree = cKDTree(shells[newest])
        for k in waiting:
            distance, nearest = tree.query(shells[k])
            i = int(distance.argmin())
            gap = float(distance[i]) * grid.spacing
            if k not in gaps or gap < gaps[k][0]:
                gaps[k] = (gap, shells[newest][nearest[i]], shells[k][i])
        newest = None
        for k in sorted(waiting, key=lambda name: gaps[name][0]):
            if gaps[k][0] <= max_gap and _continues(grid, shells[k], gaps[k][2], volume[k - 1]):
                kept.append(k)
                waiting.remove(k)
                bridges.append(gaps[k][1:])
                done.bridges.append(
                    {"gap_mm": round(1e3 * gaps[k][0], 1), "volume_ml": round(1e6 * float(volume[k - 1]), 1)}
                )
                newest = k
                break
    for k in sorted(waiting, key=lambda name: -volume[name - 1])[:20]:
        done.dropped.append({"gap_mm": round(1e3 * gaps[k][0], 1), "volume_ml": round(1e6 * float(volume[k - 1]), 1)})
    return kept, bridges


def _continues(grid: Grid, shell: np.ndarray, contact: np.ndarray, volume: float) -> bool:
    """Tells whether a piece goes on from its end as colon does: touched at an end of its long axis and not thin."""
    points = grid.points(shell)
    axis = np.linalg.svd(points - points.mean(0), full_matrices=False)[2][0] if len(points) > 2 else np.eye(3)[0]
    along = points @ axis
    length = float(np.ptp(along))
    if length < 2 * _END_REACH:
        return volume > 2e-6
    radius = float(np.sqrt(volume / (np.pi * length)))
    far = np.linalg.norm(points - grid.points(contact), axis=1).max()
    return radius > _THIN and far > 0.6 * length


def _check_extent(grid: Grid, shell: np.ndarray) -> None:
    extent = np.ptp(shell, axis=0) * grid.spacing
    if extent.max() < _LEAST_EXTENT or extent.max() > 1.0:
        size = " x ".join(f"{1e3 * value:.0f}" for value in extent)
        raise ColonImportError(
            f"No colon-like component: what was kept measures {size} mm; a colon is 200 to 700 mm across",
            "Check the units (--spacing, --units), --label and --max-gap.",
        )


def _draw_bridge(mask: np.ndarray, start: np.ndarray, end: np.ndarray, radius: float) -> None:
    """Sets the voxels within a capsule."""
    low = np.maximum(np.minimum(start, end) - int(radius) - 2, 0)
    high = np.minimum(np.maximum(start, end) + int(radius) + 3, mask.shape)
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    index = np.moveaxis(np.indices(high - low), 0, -1) + low
    way = (end - start).astype(float)
    share = np.clip((index - start) @ way / max(way @ way, 1e-9), 0.0, 1.0)
    mask[box] |= np.linalg.norm(index - start - share[..., None] * way, axis=-1) <= radius
