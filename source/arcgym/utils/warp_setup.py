# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Process-wide Warp settings; imported first by every module that imports Warp or Newton.

ARCGym never differentiates through the simulation. Without the backward pass Newton's contact kernels compile in
seconds instead of minutes. The setting is read when a kernel module is defined, hence before Newton is imported.

Kernels on a GPU take one index a thread instead of looping over a grid of threads, which spares them that loop's
instructions.

Kernels on the CPU may fuse products with sums, as they do on the GPU: physics is a tenth faster, and rounds once less.
"""

import warp as wp

from arcgym.utils.missing_driver import WARNING, driver_is_missing, without_line

wp.config.enable_backward = False
wp.config.default_grid_stride = False
wp.config.cpu_compiler_flags = f"{wp.config.cpu_compiler_flags or '-march=native'} -ffp-contract=fast"
wp.config.log_level = wp.LOG_WARNING
if driver_is_missing():
    without_line(WARNING, wp.init)

GPU_BLOCK = 128
"""Threads of a block of the kernels of wall and contact on a GPU. They need so many registers that fewer threads of
larger blocks fit a multiprocessor."""

WORLD_BLOCK = 32
"""Threads of a block of which each deals with a world: so few that the worlds are spread over many multiprocessors."""

FAST = {"fast_math": True}
"""Module options of kernels whose reciprocals, roots and logarithms on a GPU may be those of the hardware. A CPU
ignores them."""
