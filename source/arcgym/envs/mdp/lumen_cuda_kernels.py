# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""The lumen reward of :mod:`arcgym.envs.mdp.lumen_kernels` by many threads an image, for a GPU; the same to the bit but
for the rounding of the reward.

N worlds, images of H x W pixels.
"""

import warp as wp

from arcgym.envs.mdp.lumen_kernels import DeepRegion, LumenConstants, write_scores
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_block_kernels import block_least, block_most, block_sum


@wp.func
def range_together(depth: wp.array2d(dtype=float), world: int, lane: int, lanes: int, far: float) -> wp.vec2:
    """Smallest and largest depth of an image [m], clipped at ``far``; NaN if a depth is."""
    smallest = float(wp.inf)
    largest = float(-wp.inf)
    broken = wp.int64(0)
    for pixel in range(lane, depth.shape[1], lanes):
        if wp.isnan(depth[world, pixel]):
            broken = wp.int64(1)
        else:
            d = wp.min(depth[world, pixel], far)
            smallest = wp.min(smallest, d)
            largest = wp.max(largest, d)
    span = wp.vec2(block_least(smallest), block_most(largest))
    if block_sum(broken) > wp.int64(0):
        span = wp.vec2(wp.nan, wp.nan)
    return span


@wp.func
def region_together(
    depth: wp.array2d(dtype=float), width: int, world: int, lane: int, lanes: int, threshold: float, far: float
) -> DeepRegion:
    """Return number and mean place of the pixels of at least ``threshold`` [m]."""
    pixels = wp.int64(0)
    rows = wp.int64(0)
    columns = wp.int64(0)
    for pixel in range(lane, depth.shape[1], lanes):
        if wp.min(depth[world, pixel], far) >= threshold:
            pixels += wp.int64(1)
            rows += wp.int64(pixel // width)
            columns += wp.int64(pixel % width)
    region = DeepRegion()
    region.pixels = wp.max(float(block_sum(pixels)), 1.0)
    region.row = float(block_sum(rows)) / region.pixels
    region.column = float(block_sum(columns)) / region.pixels
    return region


@wp.kernel
def score_images_together(
    depth: wp.array2d(dtype=float), width: int, lanes: int, constants: LumenConstants, scores: wp.array2d(dtype=float)
):
    """Write the scores of each image. Launch (N, lanes), a block an image.

    Args:
        depth: Depth of H rows of pixels after each other [m], shape (N, H * W).
        width: Pixels of a row, W.
        lanes: Threads an image, all of a block; 1 on a CPU.
        constants: Constants of the equations.
        scores: As of ``score_images``, shape (10, N); written.
    """
    w, lane = wp.tid()
    span = range_together(depth, w, lane, lanes, constants.far)
    threshold = constants.depth_threshold * span[1]
    region = region_together(depth, width, w, lane, lanes, threshold, constants.far)
    if lane == 0:
        write_scores(constants, span, region, depth.shape[1] // width, width, w, scores)
