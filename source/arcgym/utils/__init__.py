# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tools that every room may use. Importing this package imports neither torch, Warp nor Newton; some modules do."""

from arcgym.utils.configclass import MISSING, configclass

__all__ = ["MISSING", "configclass"]
