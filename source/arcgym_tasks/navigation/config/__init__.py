# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""One package per robot; importing it registers the robot's tasks."""

from __future__ import annotations

from arcgym_tasks.navigation.config import capsule, magnetic, proximal  # noqa: F401
