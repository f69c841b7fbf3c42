# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Copies between our wall arrays (V a world) and Newton's particles (V wall vertices and A anchors a world)."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.kernel
def copy_blocks(
    source: wp.array(dtype=wp.vec3), source_stride: int, factor: float, out: wp.array(dtype=wp.vec3), stride: int
):
    """Copy the first vectors of each world's block, times ``factor``. Launch (W, V)."""
    w, i = wp.tid()
    out[w * stride + i] = factor * source[w * source_stride + i]


@wp.kernel
def add_coupling_forces(wrench: wp.array(dtype=wp.spatial_vector), weight: float, total: wp.array(dtype=wp.vec3)):
    """Add the force part of each link's coupling wrench. Launch (W*L,)."""
    i = wp.tid()
    total[i] = total[i] + weight * wp.spatial_top(wrench[i])
