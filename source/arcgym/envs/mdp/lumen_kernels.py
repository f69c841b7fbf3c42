# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""The lumen reward of a depth image in one kernel; the equations are at the head of :mod:`arcgym.envs.mdp.lumen`.

N worlds, images of H x W pixels.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class LumenConstants:
    """Fields of :class:`~arcgym.envs.mdp.lumen.LumenCfg`, of the same names and units."""

    depth_threshold: float
    mix: float
    tau_wall: float
    tau_lumen: float
    rho_min: float
    delta_min: float
    delta_good: float
    weight_centering: float
    weight_visibility: float
    far: float


@wp.struct
class DeepRegion:
    """Pixels of at least the threshold, in one image."""

    pixels: float
    """Their number."""
    row: float
    """Their mean row [pixels]."""
    column: float
    """Their mean column [pixels]."""


@wp.func
def ramp(value: float, low: float, high: float) -> float:
    """0 up to ``low``, 1 from ``high`` on, linear between."""
    return wp.clamp((value - low) / (high - low), 0.0, 1.0)


@wp.func
def depth_range(depth: wp.array3d(dtype=float), world: int, far: float) -> wp.vec2:
    """Smallest and largest depth of an image [m], clipped at ``far``; NaN if a depth is."""
    smallest = float(wp.inf)
    largest = float(-wp.inf)
    for i in range(depth.shape[1]):
        for j in range(depth.shape[2]):
            if wp.isnan(depth[world, i, j]):
                return wp.vec2(wp.nan, wp.nan)
            d = wp.min(depth[world, i, j], far)
            smallest = wp.min(smallest, d)
            largest = wp.max(largest, d)
    return wp.vec2(smallest, largest)


@wp.func
def deep_region(depth: wp.array3d(dtype=float), world: int, threshold: float, far: float) -> DeepRegion:
    """Return number and mean place of the pixels of at least ``threshold`` [m]."""
    pixels = int(0)
    rows = wp.int64(0)
    columns = wp.int64(0)
    for i in range(depth.shape[1]):
        for j in range(depth.shape[2]):
            if wp.min(depth[world, i, j], far) >= threshold:
                pixels += 1
                rows += wp.int64(i)
                columns += wp.int64(j)
    region = DeepRegion()
    region.pixels = wp.max(float(pixels), 1.0)
    region.row = float(rows) / region.pixels
    region.column = float(columns) / region.pixels
    return region


@wp.func
def write_scores(
    k: LumenConstants,
    span: wp.vec2,
    region: DeepRegion,
    height: int,
    width: int,
    w: int,
    scores: wp.array2d(dtype=float),
):
    """Write the scores of an image from its smallest and largest depth [m] and its deep region."""
    if wp.isnan(span[0]):
        for i in range(scores.shape[0]):
            scores[i, w] = wp.nan
        return
    middle = 0.5 * wp.vec2(float(height - 1), float(width - 1))
    s_c = 1.0 - wp.length(wp.vec2(region.row, region.column) - middle) / wp.length(middle)
    s_1 = ramp(span[1], k.tau_wall, k.tau_lumen)
    s_2 = ramp(region.pixels / float(height * width), k.rho_min, 1.0)
    s_3 = ramp(span[1] - span[0], k.delta_min, k.delta_good)
    s_o = 2.0 * (k.mix * s_1 + (1.0 - k.mix) * s_2) * s_3 - 1.0
    scores[0, w] = s_c
    scores[1, w] = s_1
    scores[2, w] = s_2
    scores[3, w] = s_3
    scores[4, w] = s_o
    scores[5, w] = k.weight_centering * s_c + k.weight_visibility * s_o
    scores[6, w] = region.row
    scores[7, w] = region.column
    scores[8, w] = span[0]
    scores[9, w] = span[1]


@wp.kernel
def score_images(depth: wp.array3d(dtype=float), constants: LumenConstants, scores: wp.array2d(dtype=float)):
    """Write ``s_c, s_1, s_2, s_3, s_o``, the reward, row and column of the deep region, smallest and largest depth.

    All are NaN for an image with a NaN. ``depth`` (N, H, W) [m], ``scores`` (10, N). Launch (N,).
    """
    w = wp.tid()
    span = depth_range(depth, w, constants.far)
    region = deep_region(depth, w, constants.depth_threshold * span[1], constants.far)
    write_scores(constants, span, region, depth.shape[1], depth.shape[2], w, scores)
