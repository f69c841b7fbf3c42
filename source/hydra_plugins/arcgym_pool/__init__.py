# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Hydra's launcher ``pool``: several jobs at a time on the devices of this machine."""

from hydra_plugins.arcgym_pool.pool_launcher import PoolLauncher

__all__ = ["PoolLauncher"]
