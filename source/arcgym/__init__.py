# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""ARCGym: reinforcement learning in autonomous robotic colonoscopy on the Newton physics engine."""

__version__ = "0.1.0"
