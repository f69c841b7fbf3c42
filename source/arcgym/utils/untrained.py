# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Names of the agents that learn nothing; loads no torch."""

from __future__ import annotations

UNTRAINED = ("zero", "random", "expert")
"""Agents that need no checkpoint: no motion, random actions, the robot's scripted expert."""
