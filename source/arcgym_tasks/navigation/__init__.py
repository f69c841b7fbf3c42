# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation tasks: pass one segment of the colon."""

from __future__ import annotations

from arcgym_tasks.navigation import config  # noqa: F401
from arcgym_tasks.navigation.registration import register_navigation_task, register_robot

__all__ = ["register_navigation_task", "register_robot"]
