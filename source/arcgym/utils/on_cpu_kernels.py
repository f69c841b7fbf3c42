# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Where a kernel runs."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return false;
#endif
    return true;
""")
def on_cpu() -> bool:
    """Return whether this is a CPU; known when the kernel is compiled."""
    ...
