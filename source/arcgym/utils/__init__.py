# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tools that every room may use. Nothing here imports torch, Warp or Newton on its own account."""

from arcgym.utils.configclass import MISSING, configclass

__all__ = ["MISSING", "configclass"]
