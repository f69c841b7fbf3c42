# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Process-wide Warp settings; imported first by every module that imports Warp or Newton.

ARCGym never differentiates through the simulation. Without the backward pass Newton's contact kernels compile in
seconds instead of minutes. The setting is read when a kernel module is defined, hence before Newton is imported.
"""

import warp as wp

wp.config.enable_backward = False
wp.config.log_level = wp.LOG_WARNING
