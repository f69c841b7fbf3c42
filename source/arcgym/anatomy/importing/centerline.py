# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Way through the lumen from one end to the other, kept in its middle so that touching loops are not short-cut."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from .course import resample
from .errors import ColonImportError
from .grid import Grid

_WIDE = 0.010
"""Clearance [m] at which staying clear of the wall begins to matter."""

_END_CLEARANCE = 0.004
_SHORTEST = 0.4
_WIDEST = 0.065
_OUTSIDE = -1.0


def find_path(grid: Grid, ends: list[np.ndarray | None]) -> np.ndarray:
    """Finds the way between both ends of the lumen.

    The cost of a step rises with the fourth power of the nearness of the wall, so that a window between two touching
    loops costs more than the way round.

    Args:
        grid: The cleaned lumen.
        ends: Position of the first and the last end [m], or None to take the ends that are farthest apart.

    Returns:
        Positions from the first end to the last [m], shape (n, 3).

    Raises:
        ColonImportError: A given end is not in the lumen, or the lumen is too short.
    """
    coarse = _coarse_clearance(grid)
    clearance = coarse.values
    if clearance.max() > _WIDEST:
        raise ColonImportError(
            f"No colon-like component: a ball of {2e3 * clearance.max():.0f} mm fits in; a colon is below "
            f"{2e3 * _WIDEST:.0f} mm wide",
            "Pass the mask of the colon's lumen, and --label and the units (--spacing, --units) if they are wrong.",
        )
    cost = np.where(clearance > 0, 1.0 + np.minimum((_WIDE / np.maximum(clearance, 1e-6)) ** 4, 2e3), _OUTSIDE)
    wide = clearance >= min(_END_CLEARANCE, 0.5 * float(clearance.max()))
    first, last = (None if end is None else _nearest_voxel(coarse, wide, end) for end in ends)
    if first is None:
        widest = np.array(np.unravel_index(clearance.argmax(), clearance.shape))
        first = _farthest(cost, wide, widest if last is None else last)
    if last is None:
        last = _farthest(cost, wide, first)
    path = resample(coarse.points(_trace(cost, first, last)), grid.spacing)
    path = _extended(grid, path[::-1])[::-1] if ends[0] is None else path
    path = _extended(grid, path) if ends[1] is None else path
    length = float(np.linalg.norm(np.diff(path[::5], axis=0), axis=1).sum())
    if length < _SHORTEST:
        raise ColonImportError(
            f"No colon-like component: the lumen's centreline is only {1e3 * length:.0f} mm long",
            "Check the units (--spacing, --units), --label, --max-gap and --anus/--cecum.",
        )
    return path


def _coarse_clearance(grid: Grid) -> Grid:
    """Returns the distance to the wall [m] on voxels of twice the size, the largest of eight: nothing is cut off."""
    import SimpleITK as sitk

    mask = grid.mask
    mask = np.pad(mask, [(0, size % 2) for size in mask.shape])
    image = sitk.GetImageFromArray(mask.astype(np.uint8))
    inside = sitk.SignedMaurerDistanceMap(image, insideIsPositive=True, squaredDistance=False)
    distance = np.where(mask, sitk.GetArrayViewFromImage(inside) + 1.0, 0.0).astype(np.float32)
    x, y, z = (size // 2 for size in mask.shape)
    blocks = distance.reshape(x, 2, y, 2, z, 2).max(axis=(1, 3, 5))
    return Grid(grid.spacing * blocks, grid.origin + 0.5 * grid.spacing, 2 * grid.spacing)


def _nearest_voxel(grid: Grid, wide: np.ndarray, point: np.ndarray) -> np.ndarray:
    inside = np.argwhere(wide)
    distance = np.linalg.norm(grid.points(inside) - point, axis=1)
    if distance.min() > 0.05:
        where = ", ".join(f"{1e3 * value:.0f}" for value in point)
        raise ColonImportError(
            f"The end given at {where} mm is {1e3 * distance.min():.0f} mm away from the lumen",
            "Pass --anus and --cecum in millimetres along the patient's right, anterior and cranial axes.",
        )
    return inside[distance.argmin()]


def _farthest(cost: np.ndarray, wide: np.ndarray, start: np.ndarray) -> np.ndarray:
    from skimage.graph import MCP_Geometric

    reach, _ = MCP_Geometric(cost).find_costs([tuple(start)])
    reach = np.where(wide & np.isfinite(reach), reach, -1.0)
    return np.array(np.unravel_index(reach.argmax(), reach.shape))


def _trace(cost: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    from skimage.graph import MCP_Geometric

    search = MCP_Geometric(cost)
    reach, _ = search.find_costs([tuple(first)], [tuple(last)])
    if not np.isfinite(reach[tuple(last)]):
        raise ColonImportError("The two ends are in different pieces of the lumen", "Pass a larger --max-gap.")
    return np.array(search.traceback(tuple(last)))


def _extended(grid: Grid, path: np.ndarray, step: float = 0.0005) -> np.ndarray:
    """Goes on from the path's end to the wall, along a narrow canal if there is one."""
    path = _follow_canal(grid, path)
    back = path[max(0, len(path) - 1 - round(0.02 / grid.spacing))]
    way = path[-1] - back
    way /= max(np.linalg.norm(way), 1e-9)
    ray = path[-1] + step * np.arange(1, 80)[:, None] * way
    inside = grid.sample(ray) > 0.5
    count = len(inside) if inside.all() else int(inside.argmin())
    return np.concatenate([path, ray[:count]])


def _follow_canal(grid: Grid, path: np.ndarray, reach: float = 0.06) -> np.ndarray:
    """Follows a tube that goes on beyond the end of the wide lumen, such as the anal canal."""
    from skimage.graph import MCP_Geometric

    end = np.rint(grid.index(path[-1])).astype(int)
    half = round(reach / grid.spacing)
    low = np.maximum(end - half, 0)
    high = np.minimum(end + half + 1, grid.mask.shape)
    part = grid.mask[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
    clearance = ndimage.distance_transform_edt(part) * grid.spacing
    width = float(clearance[tuple(end - low)])
    search = MCP_Geometric(np.where(part, 1.0 + np.minimum((0.003 / np.maximum(clearance, 1e-4)) ** 2, 20), _OUTSIDE))
    search.find_costs([tuple(end - low)])
    plain, _ = MCP_Geometric(np.where(part, 1.0, _OUTSIDE)).find_costs([tuple(end - low)])
    way = path[-1] - path[max(0, len(path) - 1 - round(0.03 / grid.spacing))]
    ahead = (np.indices(part.shape).reshape(3, -1).T - (end - low)) @ way > 0
    plain = np.where(np.isfinite(plain) & ahead.reshape(part.shape), plain, -1.0)
    far = np.unravel_index(plain.argmax(), plain.shape)
    if plain[far] * grid.spacing < 2.5 * width + 0.010:
        return path
    return np.concatenate([path, grid.points(np.array(search.traceback(far)) + low)[1:]])
